/* The period. From top to bottom, what is done is rarer:
 *
 *   step      the distance of this period; behind the plan's end the run creeps to the stop.
 *   follow    one evaluation at the expected sigma, and one correction, which is enough for most steps.
 *   refine    more evaluations.    search  where the expected sigma is out of range or leads past the piece.
 *   pass_end  the step ends on another piece (joints).
 *   finish    the polynomials about the new place, after all rare ways. */

#define END_OF_PIECE ONE

/* The setpoint of the place where the run stands. */
static void hold(const {{ name }}_state *state, number length, {{ name }}_setpoint *setpoint)
{
    const uint32_t last = end_piece(state) - 1u;
    setpoint->piece = (state->piece > last) ? last : state->piece;
    setpoint->phase = state->phase;
    setpoint->length = length;
    setpoint->evaluations = 0u;
    in_units_of_path(&pieces[setpoint->piece], state->at.offset, setpoint->offset);
}

/* The chord behind the schedule's end: the landing step, doubled until it moves the place. */
static number creep_length(const {{ name }}_state *state, const piece_row *row)
{
    number length = maximum(LANDING_STEP, RESOLUTION);
    for (uint32_t doubled = 0u; doubled < 64u; doubled++) {
        uint64_t phase = state->phase;
        number t = state->t;
        if (!onward(row, &phase, &t, mul(row->least_step_per_chord, length)) || (phase != state->phase){% if adds_places %} || (t > state->t){% endif %}) {
            break;
        }
        length = add(length, length);
    }
    return length;
}

/* Whether a step of `guessed` is worth an evaluation on the present piece: not if it reaches past a knot by more than the
 * usual error of a guess, 2^-8 of the way to the end, or past the whole piece{% if floating %}, or goes back{% endif %}. */
IN_PLACE bool is_on_piece(const {{ name }}_state *state, const piece_row *row, number guessed)
{
{%- if floating %}
    if (!is_part(guessed)) {
        return false;
    }
    const number rest = ONE - state->t;
    return (row->joint == CONTINUES) || !(guessed > (rest + times_power_of_two(rest, -8)));
{%- else %}
    if (guessed > state->whole) {
        return false;
    }
    if (row->joint == CONTINUES) {
        return true;
    }
    const uint64_t rest = ~state->phase;
    const uint64_t part = part_of(row, guessed);
    return (part <= rest) || ((part - rest) <= (rest >> 8));
{%- endif %}
}

/* Makes a step of this sigma from the present piece; returns all evaluations. */
static uint32_t travel({{ name }}_state *state, const piece_row *row, number length, number sigma, uint32_t evaluations)
{
    const uint64_t step = part_of(row, mul(sigma, length));
    if (after(&state->phase, step)) {
        remember(state, sigma);
        limit_trend(state, row);
        return evaluations;
    }
    return pass_end(state, row, length, step, sigma, evaluations);
}

/* Makes a step whose guess is not in its range or leads past the piece. The guess may be wrong: the step passes the end if that
 * is nearer than the length. It is not if the longest step does not reach it. Returns the evaluations. */
static uint32_t search({{ name }}_state *state, const piece_row *row, number length)
{
    const number step = step_to_end(state, row);
    if (step <= mul(row->greatest_step_per_chord, length)) {
        travelled_way way;
        set_travelled_at(state, row, step, length, &way);
        if (way.left > {{ zero }}) {
            return cross(state, row, &way, length, 0u);
        }
    }
    number sigma = expected_sigma(state, row);
    chord on;
    set_chord(&on, row, &state->at, {% if floating %}ONE{% else %}whole_of(row){% endif %}, length);
    const uint32_t evaluations = solve(&on, &sigma, MAX_EVALUATIONS);
    return travel(state, row, length, sigma, evaluations);
}

/* Makes a step on the present piece from an evaluation at `guess` that is not enough; returns all evaluations. */
static uint32_t refine({{ name }}_state *state, const piece_row *row, number length, number guess, number residual, number slope)
{
    chord on;
    evaluation value;
    number sigma = guess;
    value.residual = residual;
    value.slope = slope;
    set_chord(&on, row, &state->at, {% if floating %}ONE{% else %}state->whole{% endif %}, length);
    const uint32_t evaluations = refine_chord(&on, &sigma, &value, MAX_EVALUATIONS);
    return travel(state, row, length, sigma, evaluations);
}

/* Writes the polynomials about the place where a step arrived that was not a common one. Returns their piece. */
static uint32_t arrive({{ name }}_state *state)
{
    const uint32_t end = end_piece(state);
    if (state->piece >= end) {
        state->t = END_OF_PIECE;
        shift_to(end - 1u, END_OF_PIECE, &state->at);
        return end - 1u;
    }
    state->t = fraction(state->phase);
{%- if adds_places %}
    (void)place_to_phase(state->t, &state->phase); /* the phase has the digits of the number, and no more */
{%- endif %}
    shift_to(state->piece, state->t, &state->at);
    return state->piece;
}

/* Finishes a step that was not a common one: the place it ends at, the polynomials there and the setpoint. */
static void finish({{ name }}_state *state, number length, uint32_t evaluations, {{ name }}_setpoint *setpoint)
{
    setpoint->piece = arrive(state);
    setpoint->phase = state->phase;
    setpoint->length = length;
    setpoint->evaluations = evaluations;
    in_units_of_path(&pieces[setpoint->piece], state->at.offset, setpoint->offset);
}

/* One period with a chord of this length. The step is solved for `reach_length`, and ends where the path does if the path ends
 * within it. */
static void follow({{ name }}_state *state, number length, number reach_length, {{ name }}_setpoint *setpoint)
{
    const piece_row *row = &pieces[state->piece];
{%- if floating %}
    const number guess = sub(state->newest, state->fall);
{%- else %}
    const number least = row->least_step_per_chord;
    const number greatest = row->greatest_step_per_chord;
    number guess = {{ zero }};
    if (!difference_within(state->newest, state->fall, least, greatest, &guess)) {
        finish(state, length, search(state, row, reach_length), setpoint);
        return;
    }
{%- endif %}
    const number step = {{ factors.sigma }}(reach_length, guess);
    if (!is_on_piece(state, row, step)) {
        finish(state, length, search(state, row, reach_length), setpoint);
        return;
    }
    evaluation value;
    evaluate_on_piece(&state->at, guess, variable({% if floating %}0{% else %}row->range_exponent{% endif %}, step), &value);
{%- if floating %}
    if (!is_small(&value)) {
        finish(state, length, refine(state, row, reach_length, guess, value.residual, value.slope), setpoint);
        return;
    }
    const number sigma = sub(guess, correction(guess, value.residual, value.slope, THREE_QUARTERS));
{%- else %}
    number sigma = guess;
    if (!is_small(&value) || !difference_within(guess, correction(guess, value.residual, value.slope, THREE_QUARTERS), least, greatest, &sigma)) {
        finish(state, length, refine(state, row, reach_length, guess, value.residual, value.slope), setpoint);
        return;
    }
{%- endif %}
    const number found = {{ factors.sigma }}(reach_length, sigma);
    number t = state->t;
    if (!onward(row, &state->phase, &t, found)) {
        finish(state, length, pass_end(state, row, reach_length, part_of(row, found), sigma, 1u), setpoint);
        return;
    }
    state->t = t;
    remember(state, sigma);
    setpoint->piece = state->piece;
    setpoint->phase = state->phase;
    setpoint->length = length;
    setpoint->evaluations = 1u;
    shift_along(state->piece, row, t, &state->at);
    in_units_of_path(row, state->at.offset, setpoint->offset);
}

void {{ name }}_start({{ name }}_state *state, uint32_t section)
{
    state->section = (section < {{ upper }}_SECTIONS) ? section : ({{ upper }}_SECTIONS - 1u);
    const section_row *run = &sections[state->section];
    const piece_row *row = &pieces[run->first_piece];
    state->stage = run->first_stage;
    state->time = 0u;
    state->piece = run->first_piece;
    state->phase = 0u;
    state->t = {{ zero }};
{%- if !floating %}
    state->whole = whole_of(row);
{%- endif %}
    shift_to(state->piece, {{ zero }}, &state->at);
    /* There is no history: sigma of the first chord is found from the middle of its range. */
    uint32_t stage = state->stage;
    uint64_t time = 0u;
    number length = LANDING_STEP;
    (void)advance(end_stage(state), &stage, &time, &length);
    chord on;
    set_chord(&on, row, &state->at, {% if floating %}ONE{% else %}state->whole{% endif %}, length);
    number sigma = add(on.least, half(sub(on.greatest, on.least)));
    (void)solve(&on, &sigma, UINT8_MAX);
    be_steady(state, sigma);
}

bool {{ name }}_step({{ name }}_state *state, {{ name }}_setpoint *setpoint)
{
    const uint32_t end = end_stage(state);
    number length = {{ zero }};
    const bool is_planned = advance(end, &state->stage, &state->time, &length);
    if (state->piece >= end_piece(state)) {
        /* At the end of the path the run stands until its schedule is over. */
        if (is_planned) {
            hold(state, length, setpoint);
        }
        return is_planned;
    }
    if (!is_planned) {
        length = creep_length(state, &pieces[state->piece]);
    }
    number reach_length = length;
    if (is_planned && (state->stage >= end)) {
        /* In the schedule's last period the step reaches further, to include what rounding has left of the path. */
        reach_length = add(length, minimum(LANDING_STEP, sub(NUMBER_MAX, length)));
    }
    follow(state, length, reach_length, setpoint);
    return true;
}

void {{ name }}_position(const {{ name }}_setpoint *setpoint, int64_t position[AXES])
{
    const piece_row *row = &pieces[setpoint->piece];
    for (uint32_t d = 0u; d < AXES; d++) {
        /* Cut toward the origin to units of 2^-39 mm. */
        const number offset = setpoint->offset[d];
        const uint64_t phase = to_phase(absolute(offset), {{ position_exponent }}){% if position_shift > 0 %} >> {{ position_shift }}{% endif %};
        const uint64_t units = (phase > (uint64_t)INT64_MAX) ? (uint64_t)INT64_MAX : phase;
        const uint64_t origin = (uint64_t)row->origin[d];
        const uint64_t sum = (offset < {{ zero }}) ? (origin - units) : (origin + units);
        position[d] = (int64_t)sum;
    }
}
