// A core for one kind of part: {{ about }}
//
// Written by `feedbits compile --language verilog`, version {{ version }}; edited by nobody. The program is in microcode.hex, the part in
// part.hex. Registers have 64 bits. A number is a word of {{ bits }} bits with its sign in the bits above, {{ fraction_bits }} bits behind the point.
//
// A word of microcode is issued a cycle, unless the one before asks to wait. Stages: issue, in which rows and registers are addressed;
// read, in which operands arrive; one stage for sums, two for shifts and choices, three for products. Nothing is forwarded: words are
// ordered so that a result is there when it is read, and that one result is written a cycle.
`default_nettype none

module feedbits_core #(
    parameter MICROCODE = "microcode.hex",
    parameter PART = "part.hex",
    // So many finished setpoints wait at the output, from 1 on. A section's first one is shown when that many are there, or all.
    parameter QUEUE = 4
) (
    input  wire clk,
    input  wire reset,
    // Words of another part, while the core is idle.
    input  wire table_write,
    input  wire [{{ table_bits - 1 }}:0] table_address,
    input  wire [63:0] table_data,
    // A section begins. `done` is high for a cycle when all of its setpoints were made, and the last ones may still be in the queue; the
    // core is idle again when the last one was taken.
    input  wire start,
    input  wire [{{ bits - 2 }}:0] section,
    output wire idle,
    output reg  done,
    // High for a cycle once a period, when a setpoint is due. `error` says that none stood there between a section's first and last one,
    // and stays until the next start or reset. Where nobody gives ticks, it stays low.
    input  wire tick,
    output reg  error,
    // Setpoints, as an AXI4 stream, and the same word by word: in `setpoint_tdata` the first one is the lowest, and each is
    // continued to whole bytes, with its sign where it has one.
    output reg  setpoint_tvalid,
    input  wire setpoint_tready,
    output wire [{{ stream_bits - 1 }}:0] setpoint_tdata,
{%- for output in outputs %}
    output wire [{{ output.bits - 1 }}:0] {{ output.name }}{% if !loop.last %},{% endif %}
{%- endfor %}
);

localparam W = {{ bits }};
localparam F = {{ fraction_bits }};
localparam [63:0] HALF = 64'd1 << (F - 1);
localparam FIELD = {{ field_bits }};
localparam SLOT = {{ slot_bits }};
localparam COLUMN = {{ column_bits }};
localparam TABLE = {{ table_bits }};
localparam ADDRESS = {{ address_bits }};
localparam WORD = 14 + 4 * FIELD;
localparam SETPOINT = {{ setpoint_bits }};
localparam PLACES = QUEUE > 1 ? QUEUE : 1;
localparam PLACE = PLACES > 1 ? $clog2(PLACES) : 1;

localparam [5:0] MOVE = 1, ADD = 2, SUB = 3, ADD_NUMBERS = 4, SUB_NUMBERS = 5, MIN = 6, MAX = 7, AND = 10, OR = 11, INPUT = 15,
    LOAD = 16, OUTPUT = 17, BRANCH = 18, JUMP = 19, CALL = 20, RETURN = 21, WAIT_START = 22, WAIT_TAKEN = 23,
    SHIFT_LEFT = 24, SHIFT_RIGHT = 25, SCALE = 26, TO_PHASE = 28, PRODUCT = 32, SUM = 33, ROUNDED_SUM = 34, DIVIDE = 36, ROOT = 37;

// The last W bits, with their sign above.
function [63:0] cut(input [63:0] x);
    cut = {% raw %}{{{% endraw %}(64 - W){x[W - 1]}}, x[W - 1:0]};
endfunction

// Issue.
reg [WORD - 1:0] microcode [0:{{ words - 1 }}];
initial $readmemh(MICROCODE, microcode);

reg [ADDRESS - 1:0] next_address, ahead_next, word_next;
reg [WORD - 1:0] ahead, word;
reg ahead_valid, word_valid;
reg [5:0] waited;
reg taken;
reg [ADDRESS - 1:0] target;

wire [5:0] op = word[WORD - 1 -: 6];
wire [5:0] wait_for = word[WORD - 7 -: 6];
wire [1:0] from_table = word[WORD - 13 -: 2];
wire [FIELD - 1:0] to = word[3 * FIELD +: FIELD];
wire [FIELD - 1:0] a = word[2 * FIELD +: FIELD];
wire [FIELD - 1:0] b = word[FIELD +: FIELD];
wire [FIELD - 1:0] c = word[0 +: FIELD];

reg is_full, is_empty;
wire held = word_valid && ((op == WAIT_START && !(start && is_empty)) || (op == WAIT_TAKEN && is_full));
wire is_last = word_valid && !held && waited == wait_for;
wire moves = is_last || !word_valid;
wire fetch = taken || moves || !ahead_valid;
wire [ADDRESS - 1:0] fetched = taken ? target : next_address;
wire issue = word_valid && !held && waited == 0 && !taken;

wire begins = issue && op == WAIT_START;

assign idle = word_valid && op == WAIT_START && !taken && is_empty;

always @(posedge clk) begin
    if (fetch)
        ahead <= microcode[fetched];
end

always @(posedge clk) begin
    if (reset) begin
        next_address <= 0;
        ahead_valid <= 0;
        word_valid <= 0;
        waited <= 0;
    end else begin
        if (fetch) begin
            next_address <= fetched + 1'b1;
            ahead_next <= fetched + 1'b1;
            ahead_valid <= 1;
        end
        if (taken) begin
            word_valid <= 0;
            waited <= 0;
        end else if (moves) begin
            word <= ahead;
            word_next <= ahead_next;
            word_valid <= ahead_valid;
            waited <= 0;
        end else if (!held) begin
            waited <= waited + 1'b1;
        end
    end
end

// Registers and tables. No word is read in the cycle in which it is written: the order of the microcode sees to that.
(* no_rw_check *) reg [63:0] file_a [0:(1 << SLOT) - 1];
(* no_rw_check *) reg [63:0] file_b [0:(1 << SLOT) - 1];
(* no_rw_check *) reg [63:0] file_c [0:(1 << SLOT) - 1];
reg [TABLE - 1:0] pointers [0:{{ pointers - 1 }}];
(* no_rw_check *) reg [63:0] rows [0:(1 << TABLE) - 1];
initial $readmemh(PART, rows);
`ifndef SYNTHESIS
// Registers are written before they are read for anything that matters; a simulator that knows undefined words must not see them.
integer each;
initial begin
    for (each = 0; each < (1 << SLOT); each = each + 1) begin
        file_a[each] = 0;
        file_b[each] = 0;
        file_c[each] = 0;
    end
    for (each = 0; each < {{ pointers }}; each = each + 1)
        pointers[each] = 0;
    for (each = {{ table_words }}; each < (1 << TABLE); each = each + 1)
        rows[each] = 0;
end
`endif

wire write;
wire [SLOT - 1:0] write_to;
wire [63:0] written;
wire [FIELD - 1:0] column = from_table == 1 ? a : from_table == 2 ? b : c;
wire [TABLE - 1:0] row = pointers[column[COLUMN +: {{ pointer_bits }}]] | {% raw %}{{{% endraw %}(TABLE - COLUMN){1'b0}}, column[COLUMN - 1:0]};
reg [63:0] read_a, read_b, read_c, read_row;

always @(posedge clk) begin
    if (write)
        file_a[write_to] <= written;
    read_a <= file_a[a[SLOT - 1:0]];
end

always @(posedge clk) begin
    if (write)
        file_b[write_to] <= written;
    read_b <= file_b[b[SLOT - 1:0]];
end

always @(posedge clk) begin
    if (write)
        file_c[write_to] <= written;
    read_c <= file_c[c[SLOT - 1:0]];
end

always @(posedge clk) begin
    if (write && write_to < {{ pointers }})
        pointers[write_to[{{ pointer_bits - 1 }}:0]] <= written[TABLE - 1:0];
end

always @(posedge clk) begin
    if (table_write)
        rows[table_address] <= table_data;
    read_row <= rows[row];
end

// Read.
reg reads;
reg [5:0] read_op;
reg [1:0] read_table;
reg [FIELD - 1:0] read_to;
reg [2 * FIELD - 1:0] read_literal;
reg [FIELD - 1:0] read_last;
reg [ADDRESS - 1:0] read_link;

always @(posedge clk) begin
    reads <= issue && !reset;
    read_op <= op;
    read_table <= from_table;
    read_to <= to;
    read_literal <= {a, b};
    read_last <= c;
    read_link <= word_next;
end

// Sums, comparisons and branches.
reg sums_valid;
reg [5:0] x_op;
reg [FIELD - 1:0] x_to;
reg [FIELD - 1:0] x_last;
reg [2 * FIELD - 1:0] x_literal;
reg [ADDRESS - 1:0] x_link;
reg [63:0] x_a, x_b, x_c;
reg [{{ bits - 2 }}:0] begun;

always @(posedge clk) begin
    sums_valid <= reads && !taken && !reset;
    x_op <= read_op;
    x_to <= read_to;
    x_last <= read_last;
    x_link <= read_link;
    x_literal <= read_literal;
    x_a <= read_table == 1 ? read_row : read_a;
    x_b <= read_table == 2 ? read_row : read_b;
    x_c <= read_table == 3 ? read_row : read_c;
    if (begins)
        begun <= section;
end

wire x_valid = sums_valid && !taken;
wire [63:0] sum = x_a + x_b;
wire [64:0] difference = {1'b0, x_a} - {1'b0, x_b};
wire is_equal = x_a == x_b;
wire less_unsigned = difference[64];
wire less = x_a[63] == x_b[63] ? difference[64] : x_a[63];
reg holds;

always @* begin
    case (x_to[5:3])
        0: holds = is_equal;
        1: holds = less;
        2: holds = less || is_equal;
        3: holds = less_unsigned;
        4: holds = less_unsigned || is_equal;
        default: holds = (less || is_equal) && !sum[63]; // -b <= a <= b
    endcase
end

reg [ADDRESS - 1:0] links [0:15];
reg [3:0] depth;
wire branches = (x_op == BRANCH && holds == x_to[6]) || x_op == JUMP || x_op == CALL || x_op == RETURN;
wire [FIELD + 2:0] led = {x_to[2:0], x_last};

always @(posedge clk) begin
    if (reset) begin
        taken <= 0;
        depth <= 0;
    end else begin
        taken <= x_valid && branches;
        if (x_valid && x_op == CALL)
            depth <= depth + 1'b1;
        if (x_valid && x_op == RETURN)
            depth <= depth - 1'b1;
    end
    target <= x_op == RETURN ? links[depth - 4'd1] : led[ADDRESS - 1:0];
    if (x_valid && x_op == CALL)
        links[depth] <= x_link;
end

reg [63:0] of_sum;
reg writes_sum;

always @* begin
    writes_sum = x_valid;
    case (x_op)
        ADD: of_sum = sum;
        ADD_NUMBERS: of_sum = cut(sum);
        SUB: of_sum = difference[63:0];
        SUB_NUMBERS: of_sum = cut(difference[63:0]);
        AND: of_sum = x_a & x_b;
        OR: of_sum = x_a | x_b;
        MOVE: of_sum = x_a;
        default: begin
            of_sum = x_a;
            writes_sum = 0;
        end
    endcase
end

// Choices and words from elsewhere are kept for a cycle, for what they are is known late. A quotient or root comes the same way.
reg gives_kept;
reg [FIELD - 1:0] kept_to;
reg [63:0] kept;
reg gives;
reg [FIELD - 1:0] long_to;
reg [63:0] of_long;

always @(posedge clk) begin
    gives_kept <= (gives || (x_valid && (x_op == MIN || x_op == MAX || x_op == LOAD || x_op == INPUT))) && !reset;
    kept_to <= gives ? long_to : x_to;
    if (gives)
        kept <= of_long;
    else if (x_op == LOAD)
        kept <= {% raw %}{{{% endraw %}(64 - 2 * FIELD){1'b0}}, x_literal};
    else if (x_op == INPUT)
        kept <= {% raw %}{{{% endraw %}(65 - W){1'b0}}, begun};
    else
        kept <= less == (x_op == MIN) ? x_a : x_b;
end

// The setpoint, as its words are made.
{%- for output in outputs %}
reg [{{ output.bits - 1 }}:0] made_{{ output.name }};
{%- endfor %}

always @(posedge clk) begin
{%- for output in outputs %}
    if (x_valid && x_op == OUTPUT && x_to[3:0] == {{ loop.index0 }})
        made_{{ output.name }} <= x_a[{{ output.bits - 1 }}:0];
{%- endfor %}
end

// The queue of finished setpoints. The next one is made while there is room for it. At rest it fills before the first one is shown.
reg [SETPOINT - 1:0] queue [0:PLACES - 1];
reg [PLACE - 1:0] first, free;
reg [PLACE:0] count;
reg shows, is_over;
wire is_whole = x_valid && x_op == OUTPUT && x_to[3:0] == {{ output_whole }};
wire is_done = x_valid && x_op == OUTPUT && x_to[3:0] == {{ output_done }};
wire is_taken = setpoint_tvalid && setpoint_tready;
wire [PLACE:0] count_after = count + {{ "{{" }}PLACE{1'b0}}, is_whole} - {{ "{{" }}PLACE{1'b0}}, is_taken};
wire shows_after = !begins && (shows || is_done || count_after == PLACES);

always @(posedge clk) begin
    done <= is_done && !reset;
    if (is_whole)
        queue[free] <= {
{%- for output in highest_first -%}
made_{{ output.name }}{% if !loop.last %}, {% endif %}
{%- endfor -%}
};
    if (reset) begin
        count <= 0;
        first <= 0;
        free <= 0;
        shows <= 0;
        is_over <= 1;
        setpoint_tvalid <= 0;
        is_full <= 0;
        is_empty <= 1;
        error <= 0;
    end else begin
        if (is_whole)
            free <= free == PLACES - 1 ? 0 : free + 1'b1;
        if (is_taken)
            first <= first == PLACES - 1 ? 0 : first + 1'b1;
        count <= count_after;
        shows <= shows_after;
        is_over <= !begins && (is_over || is_done);
        setpoint_tvalid <= shows_after && count_after != 0;
        is_full <= count_after == PLACES;
        is_empty <= count_after == 0;
        error <= !begins && (error || (tick && shows && !is_over && !setpoint_tvalid));
    end
end

assign {
{%- for output in highest_first -%}
{{ output.name }}{% if !loop.last %}, {% endif %}
{%- endfor -%}
} = queue[first];
assign setpoint_tdata = {
{%- for output in highest_first -%}
{% if output.padding > 0 %}{{ "{" }}{{ output.padding }}{{ "{" }}{{ output.name }}[{{ output.bits - 1 }}]{{ "}}" }}, {% endif %}{{ output.name }}{% if !loop.last %}, {% endif %}
{%- endfor -%}
};

// Shifts: a rotation to the right, then what is left of it, rounded.
wire is_scale = x_op == SCALE;
wire to_left = x_op == SHIFT_LEFT || x_op == TO_PHASE || (is_scale && !x_b[8]);
// Beyond 63 places to either side.
wire is_far = x_b[8] ? !(&x_b[7:6]) || x_b[5:0] == 0 : |x_b[7:6];
wire [5:0] rotation = is_far ? 6'd63 : x_op == SHIFT_RIGHT ? x_b[5:0] : -x_b[5:0];
wire [63:0] turned_in = is_scale && !to_left ? {x_a[62:0], 1'b0} : x_a;
wire [63:0] turned_1 = rotation[1] ? (rotation[0] ? {turned_in[2:0], turned_in[63:3]} : {turned_in[1:0], turned_in[63:2]})
    : (rotation[0] ? {turned_in[0], turned_in[63:1]} : turned_in);
wire [63:0] turned_2 = rotation[3] ? (rotation[2] ? {turned_1[11:0], turned_1[63:12]} : {turned_1[7:0], turned_1[63:8]})
    : (rotation[2] ? {turned_1[3:0], turned_1[63:4]} : turned_1);
wire [63:0] turned_3 = rotation[5] ? (rotation[4] ? {turned_2[47:0], turned_2[63:48]} : {turned_2[31:0], turned_2[63:32]})
    : (rotation[4] ? {turned_2[15:0], turned_2[63:16]} : turned_2);
wire [63:0] below = 64'hffffffffffffffff >> rotation;
reg shifts;
reg [FIELD - 1:0] shift_to;
reg rounds, cuts, saturates, gives_none, fills;
reg [63:0] turned, mask;

always @(posedge clk) begin
    shifts <= x_valid && x_op[5:3] == 3 && !reset;
    shift_to <= x_to;
    rounds <= is_scale && !to_left;
    cuts <= is_scale;
    saturates <= x_op == TO_PHASE;
    gives_none <= (x_op == TO_PHASE && x_a[63]) || (is_far && !(is_scale && !to_left));
    fills <= is_scale && !to_left && x_a[63];
    turned <= turned_3;
    mask <= to_left && rotation != 0 ? ~below : to_left ? 64'hffffffffffffffff : below;
end

wire [63:0] shifted = (turned & mask) | (fills ? ~mask : 64'd0);
wire [W:0] rounded = shifted[W:0] + {{ "{{" }}W{1'b0}}, rounds};
wire [W - 1:0] scaled = rounds ? rounded[W:1] : shifted[W - 1:0];
wire [63:0] of_shift = gives_none ? 64'd0 : saturates && |(turned & ~mask) ? 64'hffffffffffffffff
    : cuts ? { {(64 - W){scaled[W - 1]}}, scaled} : shifted;

// Products.
{% if bits > 18 -%}
// Factors of 33 bits in parts of 17 and 16: four products.
wire is_limb = x_op[5:4] == 3;
wire [32:0] factor_a = is_limb ? {1'b0, x_op[2] ? x_a[63:32] : x_a[31:0]} : x_a[32:0];
wire [32:0] factor_b = is_limb ? {1'b0, x_op[0] ? x_b[63:32] : x_b[31:0]} : x_b[32:0];
wire signed [17:0] low_a = {1'b0, factor_a[16:0]};
wire signed [17:0] low_b = {1'b0, factor_b[16:0]};
wire signed [17:0] high_a = { {2{factor_a[32]}}, factor_a[32:17]};
wire signed [17:0] high_b = { {2{factor_b[32]}}, factor_b[32:17]};
reg signed [35:0] high_high, high_low, low_high, low_low;
wire signed [36:0] middle = high_low + low_high;
{%- else -%}
wire is_limb = x_op[5:4] == 3;
wire signed [17:0] factor_a = is_limb ? {2'b0, x_a[16 * x_op[3:2] +: 16]} : x_a[17:0];
wire signed [17:0] factor_b = is_limb ? {2'b0, x_b[16 * x_op[1:0] +: 16]} : x_b[17:0];
reg signed [35:0] whole_product;
{%- endif %}
reg multiplies, gives_product, is_number;
reg [5:0] product_op;
reg [FIELD - 1:0] product_to, total_to;
reg [63:0] product_c, total;
wire is_product = x_op[5] && x_op != DIVIDE && x_op != ROOT;

// A number is rounded by half a unit that comes with what is added.
always @(posedge clk) begin
    multiplies <= x_valid && is_product && !reset;
    product_op <= x_op;
    product_to <= x_to;
    product_c <= x_op == PRODUCT ? x_c << F | HALF : x_c + (x_op == ROUNDED_SUM ? HALF : 64'd0);
    gives_product <= multiplies && !reset;
    total_to <= product_to;
    is_number <= product_op == PRODUCT || product_op == ROUNDED_SUM;
{%- if bits > 18 %}
    high_high <= high_a * high_b;
    high_low <= high_a * low_b;
    low_high <= low_a * high_b;
    low_low <= low_a * low_b;
    total <= {high_high[29:0], low_low[33:0]} + product_c + { {10{middle[36]}}, middle, 17'd0};
end
{%- else %}
    whole_product <= factor_a * factor_b;
    total <= { {28{whole_product[35]}}, whole_product} + product_c;
end
{%- endif %}

wire [63:0] of_product = is_number ? { {(64 - W){total[F + W - 1]}}, total[F +: W]} : total;

// Quotients and roots, a bit a cycle.
reg [5:0] left;
reg works, is_first, is_root, is_negative, is_beyond, rounds_up;
reg [63:0] digits;
reg [33:0] rest;
reg [31:0] found;
reg [31:0] divisor;
wire [W - 1:0] size_a = x_a[63] ? -x_a[W - 1:0] : x_a[W - 1:0];
wire [W - 1:0] size_b = x_b[63] ? -x_b[W - 1:0] : x_b[W - 1:0];
wire [35:0] shifted_rest = is_root ? {rest, digits[63:62]} : {1'b0, rest, digits[63]};
wire [33:0] trial = is_root ? {found, 2'b01} : {2'b00, divisor};
wire fits = shifted_rest >= {2'b00, trial};
wire [35:0] rest_after = shifted_rest - {2'b00, trial};
reg [2:0] after;

always @(posedge clk) begin
    gives <= 0;
    if (reset) begin
        works <= 0;
        after <= 0;
    end else if (x_valid && (x_op == DIVIDE || x_op == ROOT)) begin
        works <= 1;
        is_root <= x_op == ROOT;
        long_to <= x_to;
        is_negative <= x_op == DIVIDE && x_a[63] != x_b[63];
        divisor <= size_b;
        is_first <= 1;
        found <= 0;
        left <= x_op == ROOT ? 6'd31 : W - 1;
        if (x_op == ROOT) begin
            digits <= x_a;
            rest <= 0;
            is_beyond <= 0;
        end else begin
            digits <= {size_a[W - F - 1:0], {(64 - W + F){1'b0}}};
            rest <= size_a[W - 1:W - F];
            is_beyond <= 0;
        end
        rounds_up <= x_a != 0;
    end else if (works) begin
        found <= {found[30:0], fits};
        rest <= fits ? rest_after[33:0] : shifted_rest[33:0];
        digits <= is_root ? digits << 2 : digits << 1;
        left <= left - 1'b1;
        is_first <= 0;
        // A quotient of more than W bits.
        if (is_first && !is_root)
            is_beyond <= rest >= {2'b00, divisor};
        if (left == 0) begin
            works <= 0;
            after <= 1;
        end
    end else if (after == 1) begin
        // A quotient from half a divisor on, a root of k from a rest above k on.
        if (is_root ? rest > {2'b00, found} : {rest[32:0], 1'b0} >= {2'b00, divisor})
            of_long <= {32'd0, found} + 1;
        else
            of_long <= {32'd0, found};
        after <= 2;
    end else if (after == 2) begin
        if (is_beyond)
            of_long <= !rounds_up ? 64'd0 : is_negative ? -(64'd1 << (W - 1)) : (64'd1 << (W - 1)) - 1;
        else if (is_negative)
            of_long <= of_long > (64'd1 << (W - 1)) ? -(64'd1 << (W - 1)) : -of_long;
        else if (of_long > (64'd1 << (W - 1)) - 1)
            of_long <= (64'd1 << (W - 1)) - 1;
        gives <= 1;
        after <= 0;
    end
end

// One result a cycle.
assign write = writes_sum || shifts || gives_product || gives_kept;
assign write_to = gives_kept ? kept_to[SLOT - 1:0] : gives_product ? total_to[SLOT - 1:0] : shifts ? shift_to[SLOT - 1:0] : x_to[SLOT - 1:0];
assign written = gives_kept ? kept : gives_product ? of_product : shifts ? of_shift : of_sum;

endmodule

`default_nettype wire
