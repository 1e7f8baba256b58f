/* Feed override and hold: the plan's own time runs at a rate from 0 to 1, counted in units of 2^-32.
 *
 * From period to period the rate changes by at most MAX_SLOPE, and that change by at most MAX_BEND, braked so that it is 0
 * when the rate reaches its target. These bounds keep the machine's acceleration and jerk together with what the plan uses. */

#define FULL_RATE {{ upper }}_FULL_RATE
#define MAX_SLOPE INT64_C({{ feeds.slope }})
#define MAX_BEND INT64_C({{ feeds.bend }})

/* J T^3 in the unit of chords, for the landing; and the part of it by which a step may be longer to reach the end. */
#define LANDING_JERK {{ landing_jerk }}
#define LANDING_REACH {{ landing_reach }}

/* Periods without a step before and after the landing, and the power of 2 of the longest quarter of one. */
#define LANDING_PAUSE 2
#define QUARTER_BITS 9

/* The root of an integer below 2^62, rounded down, bit by bit. */
static uint64_t integer_root(uint64_t square)
{
    uint64_t rest = square;
    uint64_t root = 0u;
    for (uint64_t bit = UINT64_C(1) << 60; bit != 0u; bit >>= 2) {
        if (rest >= (root + bit)) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return root;
}

/* The largest s with s + (s - MAX_BEND) + (s - 2 MAX_BEND) + ... <= distance, the terms positive. At s = k MAX_BEND the sum
 * is MAX_BEND k (k + 1)/2, which bounds k. */
static int64_t largest_that_stops(uint64_t distance)
{
    const uint64_t terms = 1u + ((integer_root((8u * (distance / (uint64_t)MAX_BEND)) + 1u) - 1u) / 2u);
    const uint64_t shortfall = (uint64_t)MAX_BEND * (((terms - 1u) * terms) / 2u);
    const uint64_t largest = (distance + shortfall) / terms;
    return (int64_t)largest;
}

/* One period toward the target. */
static void approach({{ name }}_rates *rates)
{
    const bool rises = (rates->target > rates->rate) || ((rates->target == rates->rate) && (rates->slope < 0));
    const uint64_t distance = (rates->target > rates->rate) ? (rates->target - rates->rate) : (rates->rate - rates->target);
    const int64_t toward = rises ? rates->slope : -rates->slope;
    const int64_t fastest = ((toward + MAX_BEND) < MAX_SLOPE) ? (toward + MAX_BEND) : MAX_SLOPE;
    const int64_t slowest = toward - MAX_BEND;
    int64_t slope = largest_that_stops(distance);
    slope = (slope < fastest) ? slope : fastest;
    slope = (slope > slowest) ? slope : slowest;
    rates->slope = rises ? slope : -slope;
    const int64_t rate = (int64_t)rates->rate + rates->slope;
    rates->rate = (rate < 0) ? 0u : (((uint64_t)rate < FULL_RATE) ? (uint64_t)rate : FULL_RATE);
}

/* n / d for whole numbers, n >= 0, d > 0; saturates. */
static number ratio(int32_t n, int32_t d)
{
{%- if floating %}
{%- if word_bits == 32 %}
    if ((n <= (INT32_C(1) << 24)) && (d <= (INT32_C(1) << 24))) {
        return (number)n / (number)d;
    }
    /* Whole numbers of more than 24 bits are no floats. Their quotient in 32 bits or more is rounded once; a rest sets its
     * last bit, so that it looks like no tie. */
    const uint32_t shift = (n > 0) ? (32u + leading_zeros((uint32_t)n)) : 63u;
    const uint64_t wide_n = (uint64_t)n << shift;
    const uint64_t quotient = (wide_n / (uint64_t)d) | (((wide_n % (uint64_t)d) != 0u) ? 1u : 0u);
    return (number)quotient * times_power_of_two(ONE, -(int32_t)shift);
{%- else %}
    return (number)n / (number)d;
{%- endif %}
{%- else if word_bits == 64 %}
    return divide(n, d);
{%- else %}
    const uint64_t scaled = (uint64_t)n << FRACTION_BITS;
    uint64_t quotient = scaled / (uint64_t)d;
    const uint64_t rest = scaled - (quotient * (uint64_t)d);
    if (rest >= ((uint64_t)d - rest)) {
        quotient++;
    }
    return (quotient > (uint64_t)NUMBER_MAX) ? (number)NUMBER_MAX : (number)quotient;
{%- endif %}
}

/* The landing travels what is left behind the schedule's end with the jerks c, -c, -c, c, for m periods each: in period k
 * c g_k, g = 1, 3, 6 ... m^2, m^2 ... 6, 3, 1, whose sum is 2 m^3. This is g_k for k from 1 to 4m - 2, and 0 beyond. */
static int32_t landing_weight(int32_t m, int32_t period)
{
    const int32_t mirrored = (4 * m) - (period + 1);
    const int32_t k = (period < mirrored) ? period : mirrored;
    if (k <= 0) {
        return 0;
    }
    if (k <= m) {
        return (k * (k + 1)) / 2;
    }
    const int32_t beyond = (2 * m) - k;
    return (m * m) - ((beyond * (beyond - 1)) / 2);
}

/* The smallest m, at most 2^QUARTER_BITS, with remaining/(2 m^3) <= J T^3 and remaining/(2m) <= A T^2. */
static int32_t landing_quarter(number remaining)
{
    int32_t m = 0;
    for (int32_t step = INT32_C(1) << (QUARTER_BITS - 1); step > 0; step /= 2) {
        const int32_t trial = m + step;
        if ((mul(remaining, ratio(1, 2 * trial * trial * trial)) > LANDING_JERK) || (mul(remaining, ratio(1, 2 * trial)) > LANDING_STEP)) {
            m = trial;
        }
    }
    return m + 1;
}

/* No landing is under way. */
static void begin_landing({{ name }}_rates *rates)
{
    rates->period = 0;
    rates->quarter = 0;
    rates->weight = 0;
    rates->pause_left = 0;
}

/* The chord of a step on a piece; false for a step that is longer than the piece's polynomials are scaled for: half of
 * x's unit, or the whole piece if that is the unit. */
static bool length_across(const piece_row *row, const shifted *at, number step, number *length)
{
{%- if !floating %}
    if ((row->range_exponent != row->step_exponent) && (step > power_of_two(row->range_exponent - 1))) {
        return false;
    }
{%- endif %}
    number way[AXES];
    chord on;
    set_chord(&on, row, at, {% if floating %}ONE{% else %}whole_of(row){% endif %}, ONE);
    chord_over(&on, step, step, way);
    *length = norm(way);
    return true;
}

/* The length to the end of the section: the chord to the end of the piece, the straight line to the last piece, and the
 * chord over that. False if the format cannot hold it. */
static bool remaining_length(const {{ name }}_state *state, const piece_row *row, number *remaining)
{
    const uint32_t end = sections[state->section].end_piece;
    number to_end = {{ zero }};
    if (!length_across(row, &state->at, step_to_end(state, row), &to_end)) {
        return false;
    }
    *remaining = to_end;
    if ((state->piece + 1u) >= end) {
        return true;
    }
    const piece_row *next = &pieces[state->piece + 1u];
    const piece_row *last = &pieces[end - 1u];
    number between[AXES];
    for (uint32_t d = 0u; d < AXES; d++) {
        const bool is_ahead = last->origin[d] > next->origin[d];
        const uint64_t ahead = (uint64_t)last->origin[d] - (uint64_t)next->origin[d];
        between[d] = from_phase(is_ahead ? ahead : (0u - ahead), {{ origin_exponent }});
    }
    shifted at;
    shift_to(end - 1u, {{ zero }}, &at);
    number over_last = {{ zero }};
    if (!length_across(last, &at, {% if floating %}ONE{% else %}whole_of(last){% endif %}, &over_last)) {
        return false;
    }
    const number line = norm(between);
    if (to_end > sub(NUMBER_MAX, line)) {
        return false;
    }
    const number up_to_last = add(to_end, line);
    if (up_to_last > sub(NUMBER_MAX, over_last)) {
        return false;
    }
    *remaining = add(up_to_last, over_last);
    return true;
}

/* The chord of a period behind the end of an overridden schedule, and how far it may reach; false for a landing step as
 * without override. */
static bool land(const {{ name }}_state *state, const piece_row *row, {{ name }}_rates *rates, number *length, number *reach_length)
{
    number remaining = {{ zero }};
    if (!remaining_length(state, row, &remaining)) {
        return false;
    }
    if (rates->period < INT32_MAX) {
        rates->period++;
    }
    const int32_t k = rates->period - LANDING_PAUSE;
    if (k <= 0) {
        *length = {{ zero }};
        *reach_length = {{ zero }};
        return true;
    }
    if (k == 1) {
        rates->quarter = landing_quarter(remaining);
        rates->weight = 2 * rates->quarter * rates->quarter * rates->quarter;
    }
    const int32_t share = landing_weight(rates->quarter, k);
    if ((share == 0) || (rates->weight <= share)) {
        rates->weight = 0;
        rates->pause_left = LANDING_PAUSE;
        *length = minimum(remaining, LANDING_STEP);
        *reach_length = LANDING_STEP;
        return share > 0;
    }
    *length = minimum(mul(remaining, ratio(share, rates->weight)), LANDING_STEP);
    *reach_length = *length;
    rates->weight -= share;
    return true;
}

void {{ name }}_start_rates({{ name }}_rates *rates)
{
    rates->rate = {{ upper }}_COMMANDED_RATE;
    rates->target = {{ upper }}_COMMANDED_RATE;
    rates->slope = 0;
    begin_landing(rates);
}

void {{ name }}_set_rate({{ name }}_rates *rates, uint64_t target)
{
    rates->target = (target < FULL_RATE) ? target : FULL_RATE;
}

bool {{ name }}_is_settled(const {{ name }}_rates *rates)
{
    return (rates->rate == rates->target) && (rates->slope == 0);
}

bool {{ name }}_step_overridden({{ name }}_state *state, {{ name }}_rates *rates, {{ name }}_setpoint *setpoint)
{
    const section_row *run = &sections[state->section];
    const bool has_schedule = state->stage < run->end_stage;
    number length = {{ zero }};
    approach(rates);
    if (has_schedule && (rates->rate > 0u)) {
        (void)advance_by(run->end_stage, &state->stage, &state->time, rates->rate, &length);
    }
    if (state->piece >= run->end_piece) {
        /* The run stands at its end until the schedule is over, and for the pause behind a landing. */
        if (!has_schedule && (rates->pause_left == 0)) {
            return false;
        }
        if (!has_schedule) {
            rates->pause_left--;
        }
        hold(state, {{ zero }}, setpoint);
        return true;
    }
    const piece_row *row = &pieces[state->piece];
    number reach_length = {{ zero }};
    if (has_schedule) {
        begin_landing(rates);
        const bool is_last = state->stage >= run->end_stage;
        reach_length = is_last ? add(length, minimum(LANDING_REACH, sub(NUMBER_MAX, length))) : length;
    } else if (!land(state, row, rates, &length, &reach_length)) {
        length = creep_length(state, row);
        reach_length = length;
    } else {
        /* A step of the landing. */
    }
    if (reach_length > {{ zero }}) {
        follow(state, length, reach_length, setpoint);
    } else {
        hold(state, {{ zero }}, setpoint);
    }
    return true;
}
