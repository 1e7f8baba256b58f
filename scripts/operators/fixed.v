// Operators of fixed point: WIDTH bits of which FRACTION are behind the point, two's complement. Operands are taken at a rising edge,
// and the result is there some edges later, as each module says.

// A product, rounded to nearest, ties up, in one stage: the synthesis cuts it into blocks. 2 edges.
module product #(parameter WIDTH = 32, FRACTION = 30) (
    input clk,
    input signed [WIDTH-1:0] a, b,
    output reg signed [WIDTH-1:0] y
);
    reg signed [WIDTH-1:0] held_a, held_b;
    wire signed [2*WIDTH-1:0] whole = held_a * held_b;
    wire signed [2*WIDTH-1:0] half = 1 << (FRACTION - 1);
    always @(posedge clk) begin
        held_a <= a;
        held_b <= b;
        y <= (whole + half) >>> FRACTION;
    end
endmodule

// The same product in stages: products of parts of 17 bits, of which the highest has the sign; their sums, two and two; the sum that
// rounds. Edges: 3 + the stages of sums, ceil(log2(parts^2)).
module staged_product #(parameter WIDTH = 32, FRACTION = 30) (
    input clk,
    input signed [WIDTH-1:0] a, b,
    output reg signed [WIDTH-1:0] y
);
    localparam PARTS = WIDTH <= 18 ? 1 : (WIDTH - 2) / 17 + 1;
    localparam TERMS = PARTS * PARTS;
    localparam LEVELS = $clog2(TERMS);
    reg signed [WIDTH-1:0] held_a, held_b;
    always @(posedge clk) begin
        held_a <= a;
        held_b <= b;
    end
    // Term t behind l stages of sums is at l * TERMS + t; each has its place in the whole product.
    wire [2*WIDTH*TERMS*(LEVELS+1)-1:0] sums;
    genvar i, j, l, t;
    generate
        for (i = 0; i < PARTS; i = i + 1) for (j = 0; j < PARTS; j = j + 1) begin : part
            wire signed [17:0] part_a, part_b;
            if (i == PARTS - 1) assign part_a = held_a >>> (17 * i);
            else assign part_a = {1'b0, held_a[17*i +: 17]};
            if (j == PARTS - 1) assign part_b = held_b >>> (17 * j);
            else assign part_b = {1'b0, held_b[17*j +: 17]};
            reg signed [35:0] term;
            always @(posedge clk) term <= part_a * part_b;
            wire signed [2*WIDTH-1:0] wide = term;
            assign sums[2*WIDTH*(PARTS*i + j) +: 2*WIDTH] = wide <<< (17 * (i + j));
        end
        for (l = 0; l < LEVELS; l = l + 1) for (t = 0; t < TERMS; t = t + 1) begin : level
            localparam LEFT = (TERMS + (1 << l) - 1) >> l;
            reg [2*WIDTH-1:0] of_two;
            if (2*t + 1 < LEFT)
                always @(posedge clk)
                    of_two <= sums[2*WIDTH*(l*TERMS + 2*t) +: 2*WIDTH] + sums[2*WIDTH*(l*TERMS + 2*t + 1) +: 2*WIDTH];
            else if (2*t < LEFT)
                always @(posedge clk) of_two <= sums[2*WIDTH*(l*TERMS + 2*t) +: 2*WIDTH];
            if (2*t < LEFT) assign sums[2*WIDTH*((l+1)*TERMS + t) +: 2*WIDTH] = of_two;
        end
    endgenerate
    wire signed [2*WIDTH-1:0] all = sums[2*WIDTH*LEVELS*TERMS +: 2*WIDTH];
    wire signed [2*WIDTH-1:0] half = 1 << (FRACTION - 1);
    always @(posedge clk) y <= (all + half) >>> FRACTION;
endmodule

// A sum. 2 edges.
module sum #(parameter WIDTH = 32, FRACTION = 30) (
    input clk,
    input signed [WIDTH-1:0] a, b,
    output reg signed [WIDTH-1:0] y
);
    reg signed [WIDTH-1:0] held_a, held_b;
    always @(posedge clk) begin
        held_a <= a;
        held_b <= b;
        y <= held_a + held_b;
    end
endmodule

// A quotient, cut off toward zero, one bit an edge: WIDTH + FRACTION + 1 edges, of which the first has `start`.
module quotient #(parameter WIDTH = 32, FRACTION = 30) (
    input clk,
    input start,
    input signed [WIDTH-1:0] a, b,
    output signed [WIDTH-1:0] y
);
    reg [WIDTH-1:0] divisor, result;
    reg [WIDTH+FRACTION-1:0] dividend;
    reg [WIDTH-1:0] rest;
    reg is_negative;
    wire [WIDTH:0] next = {rest, dividend[WIDTH+FRACTION-1]};
    wire [WIDTH:0] less = next - {1'b0, divisor};
    always @(posedge clk) begin
        if (start) begin
            dividend <= {a[WIDTH-1] ? -a : a, {FRACTION{1'b0}}};
            divisor <= b[WIDTH-1] ? -b : b;
            is_negative <= a[WIDTH-1] ^ b[WIDTH-1];
            rest <= 0;
        end else begin
            dividend <= dividend << 1;
            rest <= less[WIDTH] ? next[WIDTH-1:0] : less[WIDTH-1:0];
            result <= {result[WIDTH-2:0], ~less[WIDTH]};
        end
    end
    assign y = is_negative ? -result : result;
endmodule

// A square root, cut off, one bit an edge: (WIDTH + FRACTION) / 2 + 1 edges, of which the first has `start`. FRACTION and WIDTH are both even or both odd.
module root #(parameter WIDTH = 32, FRACTION = 30) (
    input clk,
    input start,
    input signed [WIDTH-1:0] a, b,
    output signed [WIDTH-1:0] y
);
    localparam BITS = (WIDTH + FRACTION) / 2;
    reg [2*BITS-1:0] radicand;
    reg [BITS-1:0] result;
    reg [BITS+1:0] rest;
    wire [BITS+3:0] next = {rest, radicand[2*BITS-1 -: 2]};
    wire [BITS+3:0] less = next - {2'b00, result, 2'b01};
    always @(posedge clk) begin
        if (start) begin
            radicand <= {a, {FRACTION{1'b0}}};
            result <= 0;
            rest <= 0;
        end else begin
            radicand <= radicand << 2;
            rest <= less[BITS+3] ? next[BITS+1:0] : less[BITS+1:0];
            result <= {result[BITS-2:0], ~less[BITS+3]};
        end
    end
    assign y = result;
endmodule
