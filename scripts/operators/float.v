// Operators of IEEE 754 binary floats: EXPONENT bits of the exponent, FRACTION bits behind the hidden one. They round to nearest, ties to
// even. Subnormal numbers are taken and given as 0, as operators for FPGAs do. What is too great, and a quotient by 0, is an infinity;
// neither an infinity nor a NaN may come in. Edges are counted from that which takes the operands.

// The float of a magnitude: `mantissa` with the hidden bit on top and below the fraction a bit that rounds and one that says whether
// anything is below it; `exponent` with a bias, may be below 1 or above the greatest. 1 edge.
module rounded #(parameter EXPONENT = 8, FRACTION = 23) (
    input clk,
    input is_negative,
    input signed [EXPONENT+1:0] exponent,
    input [FRACTION+2:0] mantissa,
    output reg [EXPONENT+FRACTION:0] y
);
    localparam signed [EXPONENT+1:0] INFINITE = (1 << EXPONENT) - 1;
    wire up = mantissa[1] & (mantissa[0] | mantissa[2]);
    wire [EXPONENT+FRACTION+1:0] packed_up = {exponent, mantissa[FRACTION+1:2]} + up;
    wire is_infinite = exponent >= INFINITE || packed_up[FRACTION +: EXPONENT] == INFINITE;
    wire is_zero = exponent < 1 || ~mantissa[FRACTION+2];
    always @(posedge clk)
        y <= {is_negative, is_zero ? {EXPONENT+FRACTION{1'b0}}
            : is_infinite ? {{EXPONENT{1'b1}}, {FRACTION{1'b0}}}
            : packed_up[EXPONENT+FRACTION-1:0]};
endmodule

// A sum: order, shift, sum, normalise, round. 6 edges.
module float_sum #(parameter EXPONENT = 8, FRACTION = 23) (
    input clk,
    input [EXPONENT+FRACTION:0] a, b,
    output [EXPONENT+FRACTION:0] y
);
    localparam BITS = FRACTION + 4, SHIFTS = $clog2(BITS + 1);
    reg [EXPONENT+FRACTION:0] held_a, held_b;
    wire swap = held_b[EXPONENT+FRACTION-1:0] > held_a[EXPONENT+FRACTION-1:0];
    wire [EXPONENT+FRACTION:0] greater = swap ? held_b : held_a, lesser = swap ? held_a : held_b;
    // Ordered.
    reg [EXPONENT-1:0] exponent1, distance1;
    reg [FRACTION:0] great1, small1;
    reg negative1, differs1;
    // Shifted to the same exponent; the lowest bit says whether anything is below.
    reg [BITS-1:0] small2, shifted;
    reg [FRACTION:0] great2;
    reg [EXPONENT-1:0] exponent2;
    reg negative2, differs2, below;
    // The sum.
    reg [BITS:0] sum3, left;
    reg [EXPONENT-1:0] exponent3;
    reg negative3;
    // Normalised.
    reg [FRACTION+2:0] mantissa4;
    reg signed [EXPONENT+1:0] exponent4;
    reg negative4;
    reg [SHIFTS-1:0] zeros;
    integer k;
    always @* begin
        shifted = {small1, 3'b0};
        below = 0;
        for (k = 0; k < SHIFTS; k = k + 1)
            if (distance1[k]) begin
                below = below | |(shifted & ((1 << (1 << k)) - 1));
                shifted = shifted >> (1 << k);
            end
        if (|(distance1 >> SHIFTS)) begin
            below = below | |shifted;
            shifted = 0;
        end
        left = sum3;
        zeros = 0;
        for (k = SHIFTS - 1; k >= 0; k = k - 1)
            if (~|(left >> (BITS + 1 - (1 << k))) && (1 << k) <= BITS) begin
                left = left << (1 << k);
                zeros = zeros + (1 << k);
            end
    end
    always @(posedge clk) begin
        held_a <= a;
        held_b <= b;
        exponent1 <= greater[FRACTION +: EXPONENT];
        distance1 <= greater[FRACTION +: EXPONENT] - lesser[FRACTION +: EXPONENT];
        great1 <= |greater[FRACTION +: EXPONENT] ? {1'b1, greater[FRACTION-1:0]} : 0;
        small1 <= |lesser[FRACTION +: EXPONENT] ? {1'b1, lesser[FRACTION-1:0]} : 0;
        negative1 <= greater[EXPONENT+FRACTION] & (lesser[EXPONENT+FRACTION] | |greater[FRACTION +: EXPONENT]);
        differs1 <= greater[EXPONENT+FRACTION] ^ lesser[EXPONENT+FRACTION];
        small2 <= {shifted[BITS-1:1], shifted[0] | below};
        great2 <= great1;
        {exponent2, negative2, differs2} <= {exponent1, negative1, differs1};
        sum3 <= differs2 ? {1'b0, great2, 3'b0} - {1'b0, small2} : {1'b0, great2, 3'b0} + {1'b0, small2};
        {exponent3, negative3} <= {exponent2, negative2};
        mantissa4 <= {left[BITS -: FRACTION+2], |left[BITS-FRACTION-2:0]};
        exponent4 <= $signed({2'b00, exponent3}) + 1 - $signed({1'b0, zeros});
        negative4 <= negative3 & |sum3;
    end
    rounded #(EXPONENT, FRACTION) last(clk, negative4, exponent4, mantissa4, y);
endmodule

// A product: of the mantissas, a stage to take it, round. 4 edges.
module float_product #(parameter EXPONENT = 8, FRACTION = 23) (
    input clk,
    input [EXPONENT+FRACTION:0] a, b,
    output [EXPONENT+FRACTION:0] y
);
    localparam BIAS = (1 << (EXPONENT - 1)) - 1;
    reg [EXPONENT+FRACTION:0] held_a, held_b;
    reg [2*FRACTION+1:0] whole1;
    reg signed [EXPONENT+1:0] exponent1, exponent2;
    reg negative1, negative2, zero1;
    reg [FRACTION+2:0] mantissa2;
    wire carry = whole1[2*FRACTION+1];
    wire [2*FRACTION+1:0] taken = carry ? whole1 : whole1 << 1;
    always @(posedge clk) begin
        held_a <= a;
        held_b <= b;
        whole1 <= {1'b1, held_a[FRACTION-1:0]} * {1'b1, held_b[FRACTION-1:0]};
        exponent1 <= $signed({2'b00, held_a[FRACTION +: EXPONENT]}) + $signed({2'b00, held_b[FRACTION +: EXPONENT]}) - BIAS;
        zero1 <= ~|held_a[FRACTION +: EXPONENT] | ~|held_b[FRACTION +: EXPONENT];
        negative1 <= held_a[EXPONENT+FRACTION] ^ held_b[EXPONENT+FRACTION];
        mantissa2 <= zero1 ? 0 : {taken[2*FRACTION+1 -: FRACTION+2], |taken[FRACTION-1:0]};
        exponent2 <= exponent1 + $signed({1'b0, carry});
        negative2 <= negative1;
    end
    rounded #(EXPONENT, FRACTION) last(clk, negative2, exponent2, mantissa2, y);
endmodule

// A quotient, one bit an edge: FRACTION + 6 edges, of which the first has `start`.
module float_quotient #(parameter EXPONENT = 8, FRACTION = 23) (
    input clk,
    input start,
    input [EXPONENT+FRACTION:0] a, b,
    output [EXPONENT+FRACTION:0] y
);
    localparam BIAS = (1 << (EXPONENT - 1)) - 1;
    reg [FRACTION:0] divisor;
    reg [FRACTION+1:0] rest;
    reg [FRACTION+2:0] result;
    reg signed [EXPONENT+1:0] exponent, exponent1;
    reg negative, negative1, is_zero;
    reg [FRACTION+2:0] mantissa1;
    wire [FRACTION+2:0] less = {1'b0, rest} - {2'b00, divisor};
    wire [FRACTION+1:0] after = less[FRACTION+2] ? rest : less[FRACTION+1:0];
    always @(posedge clk) begin
        if (start) begin
            divisor <= {1'b1, b[FRACTION-1:0]};
            rest <= {1'b1, a[FRACTION-1:0]};
            negative <= a[EXPONENT+FRACTION] ^ b[EXPONENT+FRACTION];
            is_zero <= ~|a[FRACTION +: EXPONENT];
            exponent <= ~|b[FRACTION +: EXPONENT] ? (2 << EXPONENT) - 1
                : $signed({2'b00, a[FRACTION +: EXPONENT]}) - $signed({2'b00, b[FRACTION +: EXPONENT]}) + BIAS;
        end else begin
            rest <= after << 1;
            result <= {result[FRACTION+1:0], ~less[FRACTION+2]};
        end
        mantissa1 <= is_zero ? 0 : result[FRACTION+2] ? {result[FRACTION+2:1], result[0] | |rest} : {result[FRACTION+1:0], |rest};
        exponent1 <= exponent - $signed({1'b0, ~result[FRACTION+2]});
        negative1 <= negative;
    end
    rounded #(EXPONENT, FRACTION) last(clk, negative1, exponent1, mantissa1, y);
endmodule

// A square root, one bit an edge: FRACTION + 5 edges, of which the first has `start`.
module float_root #(parameter EXPONENT = 8, FRACTION = 23) (
    input clk,
    input start,
    input [EXPONENT+FRACTION:0] a, b,
    output [EXPONENT+FRACTION:0] y
);
    localparam BIAS = (1 << (EXPONENT - 1)) - 1, BITS = FRACTION + 2;
    reg [2*BITS-1:0] radicand;
    reg [BITS-1:0] result;
    reg [BITS+1:0] rest;
    reg signed [EXPONENT+1:0] exponent, exponent1;
    reg is_zero;
    reg [FRACTION+2:0] mantissa1;
    wire [EXPONENT-1:0] own = a[FRACTION +: EXPONENT];
    wire [BITS+3:0] next = {rest, radicand[2*BITS-1 -: 2]};
    wire [BITS+3:0] less = next - {2'b00, result, 2'b01};
    always @(posedge clk) begin
        if (start) begin
            // An exponent that is odd over the bias makes the radicand twice as great.
            radicand <= own[0] ? {2'b01, a[FRACTION-1:0], {2*BITS-FRACTION-2{1'b0}}} : {1'b1, a[FRACTION-1:0], {2*BITS-FRACTION-1{1'b0}}};
            exponent <= ($signed({2'b00, own}) + BIAS) >>> 1;
            is_zero <= ~|own;
            result <= 0;
            rest <= 0;
        end else begin
            radicand <= radicand << 2;
            rest <= less[BITS+3] ? next[BITS+1:0] : less[BITS+1:0];
            result <= {result[BITS-2:0], ~less[BITS+3]};
        end
        mantissa1 <= is_zero ? 0 : {result, |rest};
        exponent1 <= exponent;
    end
    rounded #(EXPONENT, FRACTION) last(clk, 1'b0, exponent1, mantissa1, y);
endmodule
