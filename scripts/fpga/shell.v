// The core between registers that are shifted in and out, so that its clock is that of the core and not of pins.
module shell #(
    parameter SECTION_BITS = 31, TABLE_BITS = 12, STREAM_BITS = 200
) (
    input wire clk,
    input wire in,
    output reg out
);

localparam INPUTS = 5 + SECTION_BITS + TABLE_BITS + 64;
reg [INPUTS - 1:0] inputs;
reg [STREAM_BITS - 1:0] setpoint;
wire [STREAM_BITS - 1:0] data;
wire idle, done, error, valid;
reg [2:0] flags;

always @(posedge clk) begin
    inputs <= {inputs[INPUTS - 2:0], in};
    setpoint <= valid ? data : setpoint >> 1;
    flags <= {idle, done, error};
    out <= setpoint[0] ^ ^flags;
end

feedbits_core core(
    .clk(clk), .reset(inputs[0]), .start(inputs[1]), .tick(inputs[2]), .setpoint_tready(inputs[3]), .table_write(inputs[4]),
    .section(inputs[5 +: SECTION_BITS]), .table_address(inputs[5 + SECTION_BITS +: TABLE_BITS]), .table_data(inputs[INPUTS - 1 -: 64]),
    .idle(idle), .done(done), .error(error), .setpoint_tvalid(valid), .setpoint_tdata(data)
);

endmodule
