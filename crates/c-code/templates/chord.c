/* The step of a chord of length L on one piece.
 *
 * The unknown is sigma, the step eta over L. Its residual f(sigma) = |sigma q|^2 - w^2, with q = q_1 + x (q_2 + x q_3 ...) and
 * x = sigma L 2^-r, takes neither a root nor a division. With the growth of the speed
 * g = sigma^2 q (x q') - w (x w') + w^2 - 1 the correction
 *
 *     sigma <- sigma - sigma f/2 (1 - g + g^2 - 3/4 f)
 *
 * leaves an error of the order of |f| (|f| (|f| + |g|) + |g|^3).{% if !rational %} Here w = 1.{% endif %}
{%- if has_joints %}
 *
 * If a part b of the chord, over L, lies on pieces before, l = 1 - |b| is left of its length. The unknown is then tau, the step over
 * l L. With a = tau q/w the whole chord is e = b + l a, and
 *
 *     f(tau) = b a + e a - 1 - |b|,   g = e (x da/dx) + l/2 (|a|^2 - 1),   tau <- tau - tau f/2 (1 - g + g^2 - (1/2 - l/4) f).
{%- endif %} */

/* One evaluation: f and g. */
typedef struct {
    number residual;
    number slope;
} evaluation;

/* A chord that is to end on a piece. */
typedef struct {
    const shifted *at;
{%- if !floating %}
    int32_t range_exponent;
{%- endif %}
    number whole;          /* the step over the whole piece */
    number length;         /* L */
    number least;          /* the range of sigma */
    number greatest;
{%- if has_joints %}
    bool is_past_joint;    /* whether a part of the chord lies on pieces before: */
    const number *before;  /* b, that part over L */
    number left;           /* l = 1 - |b| */
{%- endif %}
} chord;

{%- if !floating %}
static bool is_within(number sigma, number least, number greatest)
{
    return (least <= sigma) && (sigma <= greatest);
}
{%- endif %}

/* `correction`, cut so that sigma stays in its range. */
static number within(number correction, number sigma, number least, number greatest)
{
    return maximum(minimum(sub(sigma, least), correction), sub(sigma, greatest));
}

/* q and x q' of one coordinate at x: one Horner chain for a value and its slope. */
IN_PLACE void chord_per_step(const number c[DEGREE], number x, number *q, number *turn)
{
{%- if degree == 1 %}
    (void)x;
    *q = c[0];
    *turn = {{ zero }};
{%- else %}
    number slope = c[DEGREE - 1u];
    number value = add({{ factors.x }}(slope, x), c[DEGREE - 2u]);
{%- if self.is_unrolled() %}
{%- for k in (1..degree - 1).rev() %}
    slope = add({{ factors.x }}(slope, x), value);
    value = add({{ factors.x }}(value, x), c[{{ k - 1 }}]);
{%- endfor %}
{%- else %}
    for (uint32_t k = DEGREE - 2u; k > 0u; k--) {
        slope = add({{ factors.x }}(slope, x), value);
        value = add({{ factors.x }}(value, x), c[k - 1u]);
    }
{%- endif %}
    *q = value;
    *turn = {{ factors.x }}(slope, x);
{%- endif %}
}
{%- if rational %}

/* w = 1 + omega_1 x + omega_2 x^2 ... and w'. */
IN_PLACE void weight_at(const shifted *at, number x, number *weight, number *weight_slope)
{
{%- if degree == 1 %}
    *weight = add({{ factors.x }}(at->weight[0], x), ONE);
    *weight_slope = at->weight[0];
{%- else %}
    number slope = at->weight[DEGREE - 1u];
    number value = add({{ factors.x }}(slope, x), at->weight[DEGREE - 2u]);
{%- if degree > 2 %}
    for (uint32_t k = DEGREE - 2u; k > 0u; k--) {
        slope = add({{ factors.x }}(slope, x), value);
        value = add({{ factors.x }}(value, x), at->weight[k - 1u]);
    }
{%- endif %}
    *weight = add({{ factors.x }}(value, x), ONE);
    *weight_slope = add({{ factors.x }}(slope, x), value);
{%- endif %}
}
{%- endif %}

/* x, the step over 2^r. */
IN_PLACE number variable(int32_t range_exponent, number step)
{
{%- if floating %}
    (void)range_exponent;
    return step;
{%- else %}
    return {{ exponents.to_variable }}(step, -range_exponent);
{%- endif %}
}

/* sigma of the whole chord at a trial. */
static number of_whole(const chord *on, number trial)
{
{%- if has_joints %}
    return on->is_past_joint ? minimum(mul(trial, on->left), on->greatest) : trial;
{%- else %}
    (void)on;
    return trial;
{%- endif %}
}

/* The step of a trial: of the whole chord, or of what is left of it. */
static number step_of(const chord *on, number trial)
{
    return mul(of_whole(on, trial), on->length);
}
{%- if has_joints %}

{%- if !floating || rational %}
/* The value limited to `most` in magnitude. */
static number limited(number value, number most)
{
    return minimum(maximum(value, negative(most)), most);
}

{% endif -%}
/* {% if floating %}The value: a float has the room that fixed point gets by halves{% else %}Half of a value, for room{% endif %}. */
static number halved_for_room(number value)
{
    return {% if floating %}value{% else %}half(value){% endif %};
}

/* {% if floating %}The value, which was not halved{% else %}Four times a value that was halved twice for room, limited to 1{% endif %}. */
static number from_quarters(number value)
{
    return {% if floating %}value{% else %}times_power_of_two(limited(value, half(ONE_HALF)), 2){% endif %};
}

/* f and g at tau, whose x is given, of a chord of which a part lies on pieces before. */
static void evaluate_past_joint(const chord *on, number tau, number x, evaluation *value)
{
    const shifted *at = on->at;
{%- if rational %}
    number weight = ONE;
    number weight_slope = {{ zero }};
    weight_at(at, x, &weight, &weight_slope);
    const number weight_turn = mul(weight_slope, x);
    const number reciprocal = divide(ONE, weight);
{%- endif %}
    /* In fixed point half of a and of e, a quarter of f and of g: so no trial needs more integer bits than the chord does. */
    const number unit = halved_for_room(ONE);
    const number trial = halved_for_room(tau);
    const number of_chord = halved_for_room(of_whole(on, tau));
    wide with_before = {% if floating %}{{ zero }}{% else %}product(0, 0){% endif %};
    wide with_whole = {% if floating %}{{ zero }}{% else %}product(0, 0){% endif %};
    wide growth = {% if floating %}{{ zero }}{% else %}product(0, 0){% endif %};
    for (uint32_t d = 0u; d < AXES; d++) {
        number q = {{ zero }};
        number turn = {{ zero }};
        chord_per_step(at->chord[d], x, &q, &turn);
{%- if rational %}
        q = mul(q, reciprocal);
        turn = mul(sub(turn, mul(q, weight_turn)), reciprocal);
        /* Weights that fall can make any of it, and more is beyond the range of the series. */
        const number pull = limited(mul(trial, turn), unit);
{%- else %}
        const number pull = mul(trial, turn);
{%- endif %}
        const number along = mul(trial, q);
        const number whole = rounded(plus(product(of_chord, q), product(unit, on->before[d])));
        with_before = plus(with_before, product(on->before[d], along));
        with_whole = plus(with_whole, product(whole, along));
        growth = plus(growth, product(whole, pull));
    }
    /* Where a points back against b, the chord is too short without b too. */
    const number on_before = halved_for_room(maximum(rounded(with_before), {{ zero }}));
    const number on_whole = rounded(with_whole);
    const number left = halved_for_room(halved_for_room(on->left));
    const number two = halved_for_room(add(unit, unit));
    const number residual = add(add(sub(on_before, two), left), on_whole);
    const number slope = add(rounded(growth), half(sub(sub(on_whole, on_before), left)));
    value->residual = from_quarters(residual);
    value->slope = from_quarters(slope);
}
{%- endif %}

/* f and g at sigma, whose x is given. */
IN_PLACE void evaluate_on_piece(const shifted *at, number sigma, number x, evaluation *value)
{
    number q = {{ zero }};
    number turn = {{ zero }};
{%- if rational %}
    number weight = ONE;
    number weight_slope = {{ zero }};
    weight_at(at, x, &weight, &weight_slope);
    const number weight_turn = mul(weight_slope, x);
    wide squares = product(negative(weight), weight);
    wide growth = plus(product(negative(weight), weight_turn), product(weight, weight));
    growth = plus(growth, product(negative(ONE), ONE));
{%- else if floating %}
    wide squares = negative(ONE);
    wide growth = {{ zero }};
{%- else if word_bits == 64 %}
    wide squares = { 0u, 0u };
    wide growth = { 0u, 0u };
{%- else %}
    wide squares = 0u;
    wide growth = 0u;
{%- endif %}
{%- for d in 0..axes %}
    chord_per_step(at->chord[{{ d }}], x, &q, &turn);
    const number along_{{ d }} = {{ factors.sigma }}(q, sigma);
    squares = plus(squares, product(along_{{ d }}, along_{{ d }}));
    growth = {% if floating && !rational && loop.first %}product(along_{{ d }}, {{ factors.sigma }}(turn, sigma)){% else %}plus(growth, product(along_{{ d }}, {{ factors.sigma }}(turn, sigma))){% endif %};
{%- endfor %}
    value->residual = {% if rational || floating %}rounded(squares){% else %}sub(rounded(squares), ONE){% endif %};
    value->slope = rounded(growth);
}

/* f and g at sigma, whose step is given, for a chord on any number of pieces. */
static void evaluate(const chord *on, number sigma, number step, evaluation *value)
{
    const number x = variable({% if floating %}0{% else %}on->range_exponent{% endif %}, step);
{%- if has_joints %}
    if (on->is_past_joint) {
        evaluate_past_joint(on, sigma, x, value);
        return;
    }
{%- endif %}
    evaluate_on_piece(on->at, sigma, x, value);
}

/* sigma f/2 (1 - g + g^2 - c f), f within 1/2, g within 3/8, and c the curvature. */
IN_PLACE number correction(number sigma, number f, number g, number curvature)
{
{%- if floating %}
    const number squared = g * g;
    const number less = curvature * f;
    const number series = ((ONE - g) + squared) - less;
    const number first = half(sigma) * f;
    return first * series;
{%- else %}
    /* The series is rounded once; 1 - g has no digits behind the last place. */
    const wide small = plus(product(g, g), product(negative(f), curvature));
    return mul_by(mul(f, half(sigma)), add(sub(ONE, g), rounded(small)));
{%- endif %}
}

{% if !floating -%}
/* sigma - part, if that is in the range. */
IN_PLACE bool difference_within(number sigma, number part, number least, number greatest, number *difference)
{
    *difference = sub(sigma, part);
    return is_within(*difference, least, greatest);
}

{% endif -%}
/* Whether one correction from an evaluation is enough. */
IN_PLACE bool is_small(const evaluation *value)
{
    return is_at_most(value->residual, RESIDUAL) && is_at_most(value->slope, GROWTH);
}

/* The correction from any evaluation, whose values are cut to the range of the series. */
static number correction_within(const chord *on, number sigma, const evaluation *value)
{
    const number f = minimum(maximum(value->residual, negative(ONE_HALF)), ONE_HALF);
    const number g = minimum(maximum(value->slope, negative(THREE_EIGHTHS)), THREE_EIGHTHS);
{%- if has_joints %}
    const number curvature = on->is_past_joint ? sub(ONE_HALF, half(half(on->left))) : THREE_QUARTERS;
    return correction(sigma, f, g, curvature);
{%- else %}
    (void)on;
    return correction(sigma, f, g, THREE_QUARTERS);
{%- endif %}
}

{% if has_joints -%}
/* part + more, at most `greatest`; `part` is not above that. */
static number sum_within(number part, number more, number greatest)
{
    return add(part, minimum(more, sub(greatest, part)));
}

{% endif -%}
/* Solves for sigma from an evaluation at a start value, which it changes; returns the evaluations made, at most `most`. */
static uint32_t refine_chord(const chord *on, number *sigma, evaluation *last, uint32_t most)
{
{%- if has_joints %}
    /* Where the chord turns at the joint, its rest is longer than what the part before leaves of its length. */
    const number greatest = on->is_past_joint ? {% if floating %}add(on->greatest, half(on->greatest)){% else %}sum_within(on->greatest, half(on->greatest), NUMBER_MAX){% endif %} : on->greatest;
{%- else %}
    const number greatest = on->greatest;
{%- endif %}
    uint32_t evaluations = 1u;
    for (;;) {
        const number trial = *sigma;
        const number by = correction_within(on, trial, last);
        *sigma = sub(trial, within(by, trial, on->least, greatest));
        const bool is_enough = (absolute(last->residual) <= FLUCTUATION) || is_small(last);
        if (is_enough || (*sigma == trial) || (evaluations >= most)) {
            return evaluations;
        }
        evaluations++;
        evaluate(on, *sigma, minimum(step_of(on, *sigma), on->whole), last);
    }
}

/* The same from the start value alone. */
static uint32_t solve(const chord *on, number *sigma, uint32_t most)
{
    evaluation value;
    evaluate(on, *sigma, minimum(step_of(on, *sigma), on->whole), &value);
    return refine_chord(on, sigma, &value, most);
}

/* The chord over a step, over a length: `part` is the step over that. */
static void chord_over(const chord *on, number step, number part, number across[AXES])
{
    const number x = variable({% if floating %}0{% else %}on->range_exponent{% endif %}, step);
{%- if rational %}
    number weight = ONE;
    number weight_slope = {{ zero }};
    weight_at(on->at, x, &weight, &weight_slope);
{%- endif %}
    for (uint32_t d = 0u; d < AXES; d++) {
        number sum = on->at->chord[d][DEGREE - 1u];
{%- if degree > 1 %}
        for (uint32_t k = DEGREE - 1u; k > 0u; k--) {
            sum = add({{ factors.x }}(sum, x), on->at->chord[d][k - 1u]);
        }
{%- else %}
        (void)x;
{%- endif %}
{%- if rational %}
        across[d] = divide(mul(sum, part), weight);
{%- else %}
        across[d] = mul(sum, part);
{%- endif %}
    }
}

/* The chord on a piece, from the place about which `at` was shifted; `whole` is the step over the piece. */
static void set_chord(chord *on, const piece_row *row, const shifted *at, number whole, number length)
{
    on->at = at;
    on->whole = whole;
    on->length = length;
{%- if !floating %}
    on->range_exponent = row->range_exponent;
{%- endif %}
    on->least = row->least_step_per_chord;
    on->greatest = row->greatest_step_per_chord;
{%- if has_joints %}
    on->is_past_joint = false;
    on->before = at->offset; /* not read */
    on->left = ONE;
{%- endif %}
}
