// Plays the rows of `feedbits interpolate --vectors` against the core, and names the first period that differs.
//
// With Icarus Verilog: iverilog -g2005 -o simulation core.v testbench.v && vvp simulation +vectors=vectors/periods.hex
// With Verilator 5:    verilator --binary --top-module testbench core.v testbench.v && obj_dir/Vtestbench +vectors=vectors/periods.hex
//
// Setpoints are taken as soon as they stand at the output. With +period=CYCLES one is taken so many cycles after the last one, and the run
// fails where it is not there yet; a section's first one is waited for. Another depth of the queue: -Ptestbench.QUEUE=8, -GQUEUE=8.
`timescale 1ns / 1ps
`default_nettype none

module testbench #(
    parameter QUEUE = 4
);

localparam PERIODS = {{ periods }};
localparam SECTIONS = {{ sections }};
localparam DIGITS = {{ number_digits }};
// No setpoint takes as many cycles.
localparam MOST_CYCLES = 1000000;
localparam AXES = {{ axes }};
localparam ROW = 32 + 32 + 32 + 8 + 64 + 4 * DIGITS * (AXES + 1) + 64 * AXES;
// The columns behind the phase: the length, the offsets, the positions.
localparam LENGTH = 4 * DIGITS * AXES + 64 * AXES;
localparam PHASE = LENGTH + 4 * DIGITS;

reg clk = 0;
reg reset = 1;
reg start = 0;
reg [{{ bits - 2 }}:0] section = 0;
wire idle, done, valid, error;
wire [{{ stream_bits - 1 }}:0] data;
{%- for output in outputs %}
wire [{{ output.bits - 1 }}:0] {{ output.name }};
{%- endfor %}

feedbits_core #(.QUEUE(QUEUE)) core(
    .clk(clk), .reset(reset), .table_write(1'b0), .table_address({% raw %}{{% endraw %}{{ table_bits }}{1'b0}}), .table_data(64'd0),
    .start(start), .section(section), .idle(idle), .done(done), .tick(tick), .error(error),
    .setpoint_tvalid(valid), .setpoint_tready(ready), .setpoint_tdata(data)
{%- for output in outputs %},
    .{{ output.name }}({{ output.name }})
{%- endfor %}
);

always #5 clk = !clk;

reg [ROW - 1:0] rows [0:PERIODS - 1];
reg [ROW - 1:0] row;
reg [8 * 1024 - 1:0] path;
integer period = 0;
integer cycle = 0;
// The cycle of the last setpoint, and cycles between ticks.
integer taken = 0;
integer pace = 0;
integer worst = 0;
integer all = 0;
reg is_last;

// The next row is a section's first, where the machine stands.
wire begins = period == 0 || rows[period][ROW - 33 -: 32] !== rows[period - 1][ROW - 33 -: 32];
wire tick = pace != 0 && cycle - taken >= pace && (begins ? valid : period < PERIODS);
wire ready = pace == 0 || tick;

task differs(input [8 * 16 - 1:0] name, input [63:0] found, input [63:0] expected);
    begin
        $display("period %0d: %0s is %h, expected %h", period, name, found, expected);
        $display("DIFFERS");
        failed;
    end
endtask

// Ends the run with a status that is not 0: Icarus has a task of its own for that, and Verilator ends so at a stop.
task failed;
    begin
`ifdef __ICARUS__
        $finish_and_return(1);
`else
        $stop;
`endif
    end
endtask

initial begin
    if (!$value$plusargs("vectors=%s", path)) begin
        $display("give +vectors=FOLDER/periods.hex of feedbits interpolate --vectors FOLDER");
        failed;
    end
    $readmemh(path, rows);
    if (!$value$plusargs("period=%d", pace))
        pace = 0;
end

always @(posedge clk) begin
    cycle <= cycle + 1;
    if (cycle - taken > MOST_CYCLES) begin
        $display("DIFFERS: no setpoint of period %0d in %0d cycles; is microcode.hex in this folder?", period, MOST_CYCLES);
        failed;
    end
    if (error) begin
        $display("LATE: no setpoint of period %0d stood there %0d cycles after the last one", period, pace);
        failed;
    end
    reset <= cycle < 4;
    start <= cycle > 8 && idle && !start && section < SECTIONS;
    if (start)
        section <= section + 1'b1;
    if (cycle > 8 && idle && !start && section == SECTIONS) begin
        if (period == PERIODS) begin
            $display("EQUAL: %0d periods; cycles a period: mean %0d, worst %0d", period, all / (PERIODS > SECTIONS ? PERIODS - SECTIONS : 1), worst);
            $finish;
        end else begin
            $display("DIFFERS: the run ends after %0d periods, expected %0d", period, PERIODS);
            failed;
        end
    end
    if (valid && ready) begin
        taken <= cycle;
        // Where a section begins the queue fills first.
        if (!begins) begin
            if (cycle - taken > worst)
                worst <= cycle - taken;
            all <= all + (cycle - taken);
        end
        row = rows[period];
        if (period >= PERIODS)
            differs("period", period, PERIODS);
        else if (^row === 1'bx) begin
            $display("DIFFERS: the vectors have no row of period %0d, of %0d that are expected", period, PERIODS);
            failed;
        end
        if (row[ROW - 1 -: 32] !== period)
            differs("row", row[ROW - 1 -: 32], period);
        // At the end of a section the rows name the piece behind it, the core the last one.
        is_last = period + 1 == PERIODS || rows[period + 1][ROW - 33 -: 32] !== row[ROW - 33 -: 32];
        if (row[ROW - 33 -: 32] !== section - 1'b1)
            differs("section", section - 1'b1, row[ROW - 33 -: 32]);
        if (piece !== row[ROW - 65 -: 32] && !(is_last && piece + 1 == row[ROW - 65 -: 32]))
            differs("piece", piece, row[ROW - 65 -: 32]);
        if (evaluations !== row[ROW - 97 -: 8])
            differs("evaluations", evaluations, row[ROW - 97 -: 8]);
        if (phase !== row[PHASE +: 64])
            differs("phase", phase, row[PHASE +: 64]);
        if (length !== row[LENGTH +: {{ bits }}])
            differs("length", length, row[LENGTH +: {{ bits }}]);
{%- for axis in axis_names %}
        if (offset_{{ axis }} !== row[64 * AXES + 4 * DIGITS * (AXES - 1 - {{ loop.index0 }}) +: {{ bits }}])
            differs("offset_{{ axis }}", offset_{{ axis }}, row[64 * AXES + 4 * DIGITS * (AXES - 1 - {{ loop.index0 }}) +: {{ bits }}]);
{%- endfor %}
        if (data !== {
{%- for output in highest_first -%}
{% if output.padding > 0 %}{{ "{" }}{{ output.padding }}{{ "{" }}{{ output.name }}[{{ output.bits - 1 }}]{{ "}}" }}, {% endif %}{{ output.name }}{% if !loop.last %}, {% endif %}
{%- endfor -%}
}) begin
            $display("DIFFERS: setpoint_tdata of period %0d is %h", period, data);
            failed;
        end
        period <= period + 1;
    end
end

endmodule

`default_nettype wire
