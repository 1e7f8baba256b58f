/* The step of a chord of length L on one piece.
 *
 * The unknown is sigma, the step eta over L. Its residual f(sigma) = |sigma q|^2 - w^2, with q = q_1 + x (q_2 + x q_3 ...) and
 * x = sigma L 2^-r, takes neither a root nor a division. With the growth of the speed
 * g = sigma^2 q (x q') - w (x w') + w^2 - 1 the correction
 *
 *     sigma <- sigma - sigma f/2 (1 - g + g^2 - 3/4 f)
 *
 * leaves an error of the order of |f| (|f| (|f| + |g|) + |g|^3).{% if !rational %} Here w = 1.{% endif %} */

/* One evaluation: f and g; over a joint f/4 and an eighth of df/dsigma. */
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
    const number *before;  /* that part, over L */
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

/* q and x q' at x: one Horner chain for a value and its slope. */
static void chord_per_step(const shifted *at, number x, number q[AXES], number turn[AXES])
{
    for (uint32_t d = 0u; d < AXES; d++) {
{%- if degree == 1 %}
        q[d] = at->chord[0][d];
        turn[d] = {{ zero }};
{%- else %}
        number slope = at->chord[DEGREE - 1u][d];
        number value = mul_add(slope, x, at->chord[DEGREE - 2u][d]);
{%- if degree > 2 %}
        for (uint32_t k = DEGREE - 2u; k > 0u; k--) {
            slope = mul_add(slope, x, value);
            value = mul_add(value, x, at->chord[k - 1u][d]);
        }
{%- endif %}
        q[d] = value;
        turn[d] = mul(slope, x);
{%- endif %}
    }
{%- if degree == 1 %}
    (void)x;
{%- endif %}
}
{%- if rational %}

/* w = 1 + omega_1 x + omega_2 x^2 ... and w'. */
static void weight_at(const shifted *at, number x, number *weight, number *weight_slope)
{
{%- if degree == 1 %}
    *weight = mul_add(at->weight[0], x, ONE);
    *weight_slope = mul_add({{ zero }}, x, at->weight[0]);
{%- else %}
    number slope = at->weight[DEGREE - 1u];
    number value = mul_add(slope, x, at->weight[DEGREE - 2u]);
{%- if degree > 2 %}
    for (uint32_t k = DEGREE - 2u; k > 0u; k--) {
        slope = mul_add(slope, x, value);
        value = mul_add(value, x, at->weight[k - 1u]);
    }
{%- endif %}
    *weight = mul_add(value, x, ONE);
    *weight_slope = mul_add(slope, x, value);
{%- endif %}
}
{%- endif %}

/* x, the step over 2^r. */
static number variable(const chord *on, number step)
{
{%- if floating %}
    (void)on;
    return step;
{%- else %}
    return times_power_of_two(step, -on->range_exponent);
{%- endif %}
}
{%- if has_joints %}

/* f/4 and an eighth of df/dsigma of f = |b + sigma v|^2 - 1, v = q/w: where b, a part of the chord, lies on pieces before.
 * All is halved, because |b + sigma v| may come near to 2. */
static void evaluate_past_joint(number sigma, const number before[AXES], const number q[AXES], const number turn[AXES]{% if rational %}, number weight, number weight_turn{% endif %}, evaluation *value)
{
{%- if rational %}
    const number reciprocal = divide(ONE, weight);
{%- endif %}
    wide squares{% if !floating %} = product({{ zero }}, {{ zero }}){% endif %};
    wide growth{% if !floating %} = product({{ zero }}, {{ zero }}){% endif %};
    for (uint32_t d = 0u; d < AXES; d++) {
{%- if rational %}
        const number v = mul(q[d], reciprocal);
        const number pull = half(add(v, mul(sub(turn[d], mul(v, weight_turn)), reciprocal)));
{%- else %}
        const number v = q[d];
        const number pull = half(add(v, turn[d]));
{%- endif %}
        const number direction = rounded(plus(product(half(sigma), v), product(ONE_HALF, before[d])));
{%- if floating %}
        squares = (d == 0u) ? product(direction, direction) : plus(squares, product(direction, direction));
        growth = (d == 0u) ? product(direction, pull) : plus(growth, product(direction, pull));
{%- else %}
        squares = plus(squares, product(direction, direction));
        growth = plus(growth, product(direction, pull));
{%- endif %}
    }
    value->residual = rounded(plus(squares, product(negative(ONE_HALF), ONE_HALF)));
    value->slope = rounded(growth);
}
{%- endif %}

/* f and g at sigma, whose step is given. */
static void evaluate(const chord *on, number sigma, number step, evaluation *value)
{
    number q[AXES];
    number turn[AXES];
    const number x = variable(on, step);
    chord_per_step(on->at, x, q, turn);
{%- if rational %}
    number weight = ONE;
    number weight_slope = {{ zero }};
    weight_at(on->at, x, &weight, &weight_slope);
    const number weight_turn = mul(weight_slope, x);
{%- endif %}
{%- if has_joints %}
    if (on->is_past_joint) {
        evaluate_past_joint(sigma, on->before, q, turn{% if rational %}, weight, weight_turn{% endif %}, value);
        return;
    }
{%- endif %}
{%- if rational %}
    wide squares = product(negative(weight), weight);
    wide growth = plus(product(negative(weight), weight_turn), product(weight, weight));
    growth = plus(growth, product(negative(ONE), ONE));
{%- else %}
    wide squares = product(negative(ONE), ONE);
    wide growth = product({{ zero }}, {{ zero }});
{%- endif %}
    for (uint32_t d = 0u; d < AXES; d++) {
        const number along = mul(sigma, q[d]);
        squares = plus(squares, product(along, along));
        const wide more = product(along, mul(sigma, turn[d]));
{%- if floating && !rational %}
        growth = (d == 0u) ? more : plus(growth, more);
{%- else %}
        growth = plus(growth, more);
{%- endif %}
    }
    value->residual = rounded(squares);
    value->slope = rounded(growth);
}

/* sigma f/2 (1 - g + g^2 - 3/4 f), f within 1/2 and g within 3/8. */
static number correction(number sigma, number f, number g)
{
{%- if floating %}
    const number squared = g * g;
    const number less = THREE_QUARTERS * f;
    const number series = ((ONE - g) + squared) - less;
    const number first = half(sigma) * f;
    return first * series;
{%- else %}
    /* The series is rounded once. */
    wide series = product(sub(ONE, g), ONE);
    series = plus(series, product(g, g));
    series = plus(series, product(negative(f), ONE_HALF));
    series = plus(series, product(negative(f), ONE_QUARTER));
    return mul(mul(half(sigma), f), rounded(series));
{%- endif %}
}

/* sigma - part, if that is in the range{% if floating %}, which for a float are all positive numbers{% endif %}. */
static bool difference_within(number sigma, number part, number least, number greatest, number *difference)
{
    *difference = sub(sigma, part);
{%- if floating %}
    (void)least;
    (void)greatest;
    return *difference > {{ zero }};
{%- else %}
    return is_within(*difference, least, greatest);
{%- endif %}
}
{%- if has_joints %}

/* f / (df/dsigma), at most `bound`. Where the chord shrinks along the step, as behind a sharp corner, the trial goes on. */
static number joint_correction(const evaluation *value, number bound)
{
    const number f = value->residual;
{%- if floating %}
    const number least = {{ zero }};
{%- else %}
    /* A quotient of 2 or more is beyond the bound, and might not fit. */
    const number least = times_power_of_two(absolute(f), -2);
{%- endif %}
    if (value->slope > least) {
        return minimum(maximum(divide(half(f), value->slope), negative(bound)), bound);
    }
    return (f < {{ zero }}) ? negative(bound) : bound;
}
{%- endif %}

/* Whether one correction from an evaluation is enough. */
static bool is_small(const evaluation *value)
{
    return (absolute(value->residual) <= RESIDUAL) && (absolute(value->slope) <= GROWTH);
}

/* The same for a chord on any number of pieces. */
static bool is_enough(const chord *on, const evaluation *value)
{
{%- if has_joints %}
    if (on->is_past_joint) {
        return absolute(value->residual) <= times_power_of_two(FLUCTUATION, -2);
    }
{%- else %}
    (void)on;
{%- endif %}
    return (absolute(value->residual) <= FLUCTUATION) || is_small(value);
}

/* Solves for sigma from an evaluation at a start value, which it changes; returns the evaluations made, at most `most`. */
static uint32_t refine_chord(const chord *on, number *sigma, evaluation *last, uint32_t most)
{
    uint32_t evaluations = 1u;
    for (;;) {
        number by;
{%- if has_joints %}
        if (on->is_past_joint) {
            by = joint_correction(last, half(on->greatest));
        } else {
{%- else %}
        {
{%- endif %}
            const number f = minimum(maximum(last->residual, negative(ONE_HALF)), ONE_HALF);
            const number g = minimum(maximum(last->slope, negative(THREE_EIGHTHS)), THREE_EIGHTHS);
            by = correction(*sigma, f, g);
        }
        const number trial = *sigma;
        *sigma = sub(trial, within(by, trial, on->least, on->greatest));
        if (is_enough(on, last) || (*sigma == trial) || (evaluations >= most)) {
            return evaluations;
        }
        evaluations++;
        evaluate(on, *sigma, minimum(mul(*sigma, on->length), on->whole), last);
    }
}

/* The same from the start value alone. */
static uint32_t solve(const chord *on, number *sigma, uint32_t most)
{
    evaluation value;
    evaluate(on, *sigma, minimum(mul(*sigma, on->length), on->whole), &value);
    return refine_chord(on, sigma, &value, most);
}

/* The chord over a step. */
static void over(const chord *on, number step, number across[AXES])
{
    const number x = variable(on, step);
{%- if rational %}
    number weight = ONE;
    number weight_slope = {{ zero }};
    weight_at(on->at, x, &weight, &weight_slope);
{%- endif %}
    for (uint32_t d = 0u; d < AXES; d++) {
        number sum = on->at->chord[DEGREE - 1u][d];
{%- if degree > 1 %}
        for (uint32_t k = DEGREE - 1u; k > 0u; k--) {
            sum = mul_add(sum, x, on->at->chord[k - 1u][d]);
        }
{%- else %}
        (void)x;
{%- endif %}
{%- if rational %}
        across[d] = divide(mul(sum, step), weight);
{%- else %}
        across[d] = mul(sum, step);
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
{%- endif %}
}
