/* Pieces: the path as short polynomials, and their coefficients about the place where a step begins. */
{%- if !floating %}

/* 2^s, the step over the whole piece. */
static number whole_of(const piece_row *row)
{
    return power_of_two(row->step_exponent);
}
{%- endif %}

/* A step as a part of the piece, in units of 2^-64. */
static uint64_t part_of(const piece_row *row, number step)
{
{%- if floating %}
    (void)row;
    return to_phase(step, 0);
{%- else %}
    return to_phase(step, -(int32_t)row->step_exponent);
{%- endif %}
}

/* One sweep of Horner's scheme from the top coefficient down to number `low`: each entry becomes the sum so far. */
static void divide_rows(number rows[DEGREE][AXES], uint32_t low, number t)
{
    for (uint32_t k = DEGREE - 1u; k > low; k--) {
        for (uint32_t d = 0u; d < AXES; d++) {
            rows[k - 1u][d] = mul_add(rows[k][d], t, rows[k - 1u][d]);
        }
    }
}
{%- if rational %}

/* Turns N and its derivatives about t into P and the chord's numerator, c_k - P omega_k, all over W(t). `turns` becomes
 * omega_k / W(t). */
static void divide_by_weight(uint32_t piece, number t, number rows[DEGREE][AXES], number offset[AXES], number turns[DEGREE])
{
    /* The same repeated division as of N. The first sweep takes the coefficients from the table. */
    turns[DEGREE - 1u] = weights[piece][DEGREE];
    for (uint32_t k = DEGREE - 1u; k > 0u; k--) {
        turns[k - 1u] = mul_add(turns[k], t, weights[piece][k]);
    }
    const number reciprocal = divide(ONE, add(weights[piece][0], mul(turns[0], t)));
    for (uint32_t low = 0u; low < DEGREE; low++) {
        for (uint32_t k = DEGREE - 1u; k > low; k--) {
            turns[k - 1u] = mul_add(turns[k], t, turns[k - 1u]);
        }
    }
    for (uint32_t d = 0u; d < AXES; d++) {
        offset[d] = mul(offset[d], reciprocal);
    }
    for (uint32_t k = 0u; k < DEGREE; k++) {
        turns[k] = mul(turns[k], reciprocal);
        for (uint32_t d = 0u; d < AXES; d++) {
            rows[k][d] = rounded(plus(product(rows[k][d], reciprocal), product(negative(offset[d]), turns[k])));
        }
    }
}
{%- endif %}

/* Writes the piece's polynomials about t into `at`: repeated synthetic division, p (p + 1) / 2 products a coordinate.
{%- if floating %} */
{%- else %} Of
 * the coefficients the first `count` are written. */
{%- endif %}
static void shift_to(uint32_t piece, number t, {% if !floating %}uint32_t count, {% endif %}shifted *at)
{
{%- if floating %}
    number (*const rows)[AXES] = at->chord;
{%- else %}
    number rows[DEGREE][AXES];
{%- endif %}
    /* The first sweep takes the coefficients from the table. Without a loop, a copy becomes no call of memcpy. */
{%- for d in 0..axes %}
    rows[DEGREE - 1u][{{ d }}] = numerators[piece][DEGREE - 1u][{{ d }}];
{%- endfor %}
    for (uint32_t d = 0u; d < AXES; d++) {
{%- if degree > 1 %}
        for (uint32_t k = DEGREE - 1u; k > 0u; k--) {
            rows[k - 1u][d] = mul_add(rows[k][d], t, numerators[piece][k - 1u][d]);
        }
{%- endif %}
        at->offset[d] = mul(rows[0][d], t);
    }
    for (uint32_t low = 0u; low < DEGREE; low++) {
        divide_rows(rows, low, t);
    }
{%- if rational && floating %}
    divide_by_weight(piece, t, rows, at->offset, at->weight);
{%- else if rational %}
    number turns[DEGREE];
    divide_by_weight(piece, t, rows, at->offset, turns);
{%- endif %}
{%- if !floating %}
    /* From h^k in units of 2^e mm to eta x^(k-1) in units of 2^-{{ chord_exponent }} mm: h^k = x^k 2^(k (r - s)). */
    const piece_row *row = &pieces[piece];
    const int32_t per_power = (int32_t)row->range_exponent - row->step_exponent;
    int32_t exponent = (int32_t)row->coordinate_exponent - row->range_exponent + {{ upper }}_CHORD_EXPONENT;
{%- if rational %}
    int32_t weight_exponent = 0;
{%- endif %}
    for (uint32_t k = 0u; k < count; k++) {
        exponent += per_power;
        for (uint32_t d = 0u; d < AXES; d++) {
            at->chord[k][d] = times_power_of_two(rows[k][d], exponent);
        }
{%- if rational %}
        weight_exponent += per_power;
        at->weight[k] = times_power_of_two(turns[k], weight_exponent);
{%- endif %}
    }
{%- endif %}
}

/* The offset of a piece's point in the units of setpoints. */
static void in_units_of_path(const piece_row *row, const number offset[AXES], number in_units[AXES])
{
{%- if floating %}
    (void)row;
{%- for d in 0..axes %}
    in_units[{{ d }}] = offset[{{ d }}];
{%- endfor %}
{%- else %}
    /* The path's unit is that of the piece with the largest. */
    const int32_t coarser = {{ upper }}_COORDINATE_EXPONENT - (int32_t)row->coordinate_exponent;
    const uint32_t distance = (uint32_t)coarser;
    for (uint32_t d = 0u; d < AXES; d++) {
        in_units[d] = divided_by_power_of_two(offset[d], distance);
    }
{%- endif %}
}

/* The phase at the end of a step on its piece; false past the end. */
static bool after(uint64_t *phase, uint64_t step)
{
    if (step >= ~*phase) {
        return false;
    }
    *phase += step;
    return true;
}

/* The place on a piece at the end of a step, as phase and as number; false past the end. */
static bool onward(const piece_row *row, uint64_t *phase, number *t, number step)
{
{%- if adds_places %}
    (void)row;
    const number reached = *t + step;
    if (!place_to_phase(reached, phase)) {
        return false;
    }
    *t = reached;
    return true;
{%- else %}
    if (!after(phase, part_of(row, step))) {
        return false;
    }
    *t = fraction(*phase);
    return true;
{%- endif %}
}

/* The step from a place to the end of its piece. */
static number step_to_end(const {{ name }}_state *state, const piece_row *row)
{
    const uint64_t rest = 0u - state->phase; /* 2^64 - phase; 0 stands for a whole piece */
{%- if floating %}
    (void)row;
    return (rest == 0u) ? ONE : from_phase(rest, 0);
{%- else %}
    return (rest == 0u) ? whole_of(row) : from_phase(rest, row->step_exponent);
{%- endif %}
}
