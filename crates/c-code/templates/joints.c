/* Steps over the joints of pieces. Where the polynomial continues, only the end of a step is converted to the next piece. At
 * a knot another polynomial begins: the chord up to the knot is subtracted, and the rest is solved on the next piece. Behind
 * a corner the rest is a chord of its own. */

/* The part of a chord up to a joint: as a vector over L, the step over L, and the length that is left over L. */
typedef struct {
    number before[AXES];
    number part;
    number left;
} travelled_way;

/* sigma becomes the newest of the trend. */
IN_PLACE void remember({{ name }}_state *state, number sigma)
{
    const number rise = sub(sigma, state->newest);
    state->fall = sub(sub(state->rise, rise), rise);
    state->rise = rise;
    state->newest = sigma;
}

/* The trend's expected sigma, limited to the range of the piece. */
static void limit_trend({{ name }}_state *state, const piece_row *row)
{
    state->fall = within(state->fall, state->newest, row->least_step_per_chord, row->greatest_step_per_chord);
}

/* The expected next sigma, limited to the range of the piece. */
static number expected_sigma(const {{ name }}_state *state, const piece_row *row)
{
    return sub(state->newest, within(state->fall, state->newest, row->least_step_per_chord, row->greatest_step_per_chord));
}

/* The trend of a constant sigma. */
static void be_steady({{ name }}_state *state, number sigma)
{
    state->newest = sigma;
    state->rise = {{ zero }};
    state->fall = {{ zero }};
}

/* Sets what is travelled, a vector over L and a step over L, and with it what is left. */
static void set_travelled(travelled_way *way, const number before[AXES], number part)
{
{%- for d in 0..axes %}
    way->before[{{ d }}] = before[{{ d }}];
{%- endfor %}
    way->part = part;
    way->left = sub(ONE, norm(before));
}

{% if uses.breaks -%}
/* Nothing is travelled. Without a loop, zeros become no call of memset. */
static void begin_anew(travelled_way *way)
{
{%- for d in 0..axes %}
    way->before[{{ d }}] = {{ zero }};
{%- endfor %}
    way->part = {{ zero }};
    way->left = ONE;
}

{% endif -%}
/* What of a length is travelled by `step`, which leads to the end of the present piece. */
static void set_travelled_at(const {{ name }}_state *state, const piece_row *row, number step, number length, travelled_way *travelled)
{
    const number part = minimum(divide(step, length), row->greatest_step_per_chord);
    chord on;
    set_chord(&on, row, &state->at, {% if floating %}ONE{% else %}whole_of(row){% endif %}, length);
    number way[AXES];
    chord_over(&on, step, part, way);
    set_travelled(travelled, way, part);
}
{%- if has_joints %}

/* The factor that takes steps per chord on a piece to the scale of the next one{% if !floating %}, but for a power of two{% endif %}. */
static number joint_factor(const piece_row *row)
{
    const number ratio = fraction((uint64_t)row->joint_ratio << 48);
    return {% if floating %}times_power_of_two(ratio, row->joint_exponent){% else %}ratio{% endif %};
}

/* A part of a step per chord, times the factor of the joint behind `row`, in the scale of the next piece: at most the greatest there. */
static number part_into_next(const piece_row *row, number factor, const piece_row *next, number part)
{
    const number greatest = next->greatest_step_per_chord;
{%- if floating %}
    (void)row;
    return minimum(mul(part, factor), greatest);
{%- else %}
    const int32_t exponent = row->joint_exponent;
    number small = mul(part, factor);
    /* Compared in the smaller scale: the number in the larger one might not fit. */
    if (exponent > 0) {
        small = minimum(small, times_power_of_two(greatest, -exponent));
    }
    return minimum(times_power_of_two(small, exponent), greatest);
{%- endif %}
}

/* A step per chord in the scale of the next piece, in the range there. */
static number into_next(const piece_row *row, number factor, const piece_row *next, number sigma)
{
    return maximum(next->least_step_per_chord, part_into_next(row, factor, next, sigma));
}

/* The trend in the scale of the next piece, each of its three sigma limited to the range there. */
static void trend_into_next({{ name }}_state *state, const piece_row *row, number factor, const piece_row *next)
{
    const number middle = sub(state->newest, state->rise);
    const number oldest = sub(middle, add(add(state->fall, state->rise), state->rise));
    const number newest_there = into_next(row, factor, next, state->newest);
    const number middle_there = into_next(row, factor, next, middle);
    state->newest = middle_there;
    state->rise = sub(middle_there, into_next(row, factor, next, oldest));
    state->fall = {{ zero }};
    remember(state, newest_there);
}

/* The expected sigma of the last part of the next step, over so much of its length. The part begins later than the step and ends
 * with it: sigma has gone on by half of that. */
static number expected_of_rest(const {{ name }}_state *state, const piece_row *row, number left)
{
    const number least = row->least_step_per_chord;
    const number greatest = row->greatest_step_per_chord;
    const number fall = within(state->fall, state->newest, least, greatest);
    const number expected = sub(state->newest, fall);
    return sub(expected, within(half(mul(fall, sub(ONE, left))), expected, least, greatest));
}

/* Moves to a place on a piece, reached with sigma. */
static void reach({{ name }}_state *state, uint32_t piece, uint64_t phase, number sigma)
{
    remember(state, sigma);
    state->piece = piece;
    state->phase = phase;
{%- if !floating %}
    state->whole = (piece < end_piece(state)) ? whole_of(&pieces[piece]) : ONE;
{%- endif %}
}
{%- if uses.continues %}

/* Passes a joint behind which the polynomial continues, by a step of `step` / 2^64 of the piece; false where another
 * polynomial follows, or the step was not found on this piece. */
static bool pass_joint({{ name }}_state *state, const piece_row *row, uint64_t step, number sigma)
{
    const bool is_last = (state->piece + 1u) >= end_piece(state);
    const bool is_found = (row->least_step_per_chord < sigma) && (sigma < row->greatest_step_per_chord) && (step < UINT64_MAX);
    if (is_last || (row->joint != CONTINUES) || !is_found) {
        return false;
    }
    const piece_row *next = &pieces[state->piece + 1u];
    /* What exceeds the rest of the piece lies beyond its end; the next piece is wider by a power of two. */
    const uint64_t rest = 0u - state->phase;
    const uint64_t beyond = (step > rest) ? (step - rest) : 0u;
{%- if floating %}
    const int32_t exponent = (int32_t)row->joint_exponent - 1;
{%- else %}
    const int32_t exponent = (int32_t)row->joint_exponent - 1 + row->step_exponent - next->step_exponent;
{%- endif %}
    const int32_t places = (exponent < 0) ? -exponent : exponent;
    const uint32_t distance = (uint32_t)places;
    uint64_t phase = 0u;
    if (distance >= 64u) {
        if ((exponent > 0) && (beyond != 0u)) {
            return false;
        }
    } else if (exponent <= 0) {
        phase = beyond >> distance;
    } else {
        phase = beyond << distance;
        if ((phase >> distance) != beyond) {
            return false;
        }
    }
    const number factor = joint_factor(row);
    trend_into_next(state, row, factor, next);
    reach(state, state->piece + 1u, phase, into_next(row, factor, next, sigma));
    return true;
}
{%- endif %}

/* Adds the way over the whole piece, if the whole length is not travelled at its end; `part` is what was travelled before, as a step
 * on it, over L. */
static bool pass(travelled_way *way, const chord *on, number part)
{
    const number greatest = on->greatest;
    const number whole = minimum(divide(on->whole, on->length), greatest);
    number across[AXES];
    number in_halves[AXES];
    chord_over(on, on->whole, whole, across);
    for (uint32_t d = 0u; d < AXES; d++) {
        /* In halves, because the sum may not fit before it is known to be short. */
        in_halves[d] = add(half(way->before[d]), half(across[d]));
    }
    if (!(norm(in_halves) < ONE_HALF)) {
        return false;
    }
    for (uint32_t d = 0u; d < AXES; d++) {
        across[d] = add(way->before[d], across[d]);
    }
    set_travelled(way, across, sum_within(part, whole, greatest));
    return true;
}
{%- if uses.breaks %}

/* sigma of a short chord from the begin of a piece: 1/|C'|, in its range. */
static number first_step_per_chord(const shifted *at, const piece_row *row)
{
    const number speed_vector[AXES] = { {% for d in 0..axes %}at->chord[{{ d }}][0]{% if !loop.last %}, {% endif %}{% endfor %} };
    const number speed = norm(speed_vector);
    if (speed > {{ zero }}) {
        return minimum(maximum(divide(ONE, speed), row->least_step_per_chord), row->greatest_step_per_chord);
    }
    return row->greatest_step_per_chord;
}
{%- endif %}
{%- endif %}

/* Makes a step over one joint or more, with the way up to the first, which it changes, after so many evaluations. Returns
 * all evaluations: the pieces share MAX_EVALUATIONS, and once they are used up each further piece takes up to
 * BEHIND_JOINT. */
static uint32_t cross({{ name }}_state *state, const piece_row *from, travelled_way *way, number whole_length, uint32_t before)
{
{%- if has_joints %}
    const uint32_t end = end_piece(state);
    const piece_row *row = from;
{%- if uses.breaks %}
    number length = whole_length;
{%- else %}
    const number length = whole_length;
{%- endif %}
    uint32_t evaluations = before;
    for (uint32_t piece = state->piece + 1u; piece < end; piece++) {
        const piece_row *next = &pieces[piece];
        const number factor = joint_factor(row);
        trend_into_next(state, row, factor, next);
{%- if uses.breaks %}
        const bool is_corner = (row->joint == BREAKS);
        if (is_corner) {
            length = mul(length, way->left);
            begin_anew(way);
        }
{%- endif %}
        const number part = part_into_next(row, factor, next, way->part);
        if ({% if uses.breaks %}(is_corner ? length : way->left){% else %}way->left{% endif %} <= {{ zero }}) {
            reach(state, piece, 0u, state->newest);
            limit_trend(state, next);
            return evaluations;
        }
        shifted at;
        shift_to(piece, {{ zero }}, &at);
        chord on;
        set_chord(&on, next, &at, {% if floating %}ONE{% else %}whole_of(next){% endif %}, length);
{%- if uses.breaks %}
        if (is_corner) {
            be_steady(state, first_step_per_chord(&at, next));
        } else {
{%- else %}
        {
{%- endif %}
            on.is_past_joint = true;
            on.before = way->before;
            on.left = way->left;
        }
        number sigma = expected_of_rest(state, next, way->left);
        const bool is_long = step_of(&on, sigma) >= on.whole;
        bool is_past = is_long && pass(way, &on, part);
        if (!is_past) {
            const uint32_t left = (evaluations < MAX_EVALUATIONS) ? (MAX_EVALUATIONS - evaluations) : 0u;
            evaluations += solve(&on, &sigma, (left > BEHIND_JOINT) ? left : BEHIND_JOINT);
            const number step = step_of(&on, sigma);
            is_past = !((step < on.whole) || is_long) && pass(way, &on, part);
            if (!is_past) {
                const number whole = sum_within(part, of_whole(&on, sigma), next->greatest_step_per_chord);
                reach(state, piece, part_of(next, step), maximum(next->least_step_per_chord, whole));
                limit_trend(state, next);
                return evaluations;
            }
        }
        row = next;
    }
    reach(state, end, 0u, state->newest);
    return evaluations;
{%- else %}
    /* Every section is one piece: behind its end nothing follows. */
    (void)from;
    (void)way;
    (void)whole_length;
    state->piece = end_piece(state);
    state->phase = 0u;
    return before;
{%- endif %}
}

/* Makes a step of `step` / 2^64 of the piece that leads past its end; returns all evaluations. */
static uint32_t pass_end({{ name }}_state *state, const piece_row *row, number length, uint64_t step, number sigma, uint32_t evaluations)
{
{%- if has_joints && uses.continues %}
    if (pass_joint(state, row, step, sigma)) {
        return evaluations;
    }
{%- else %}
    (void)step;
    (void)sigma;
{%- endif %}
    travelled_way way;
    set_travelled_at(state, row, step_to_end(state, row), length, &way);
    return cross(state, row, &way, length, evaluations);
}
