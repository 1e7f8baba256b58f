/* Pieces: the path as short polynomials, and their coefficients about the place where a step begins. */
{%- if !floating %}

/* 2^s, the step over the whole piece. */
static number whole_of(const piece_row *row)
{
    return power_of_two(row->step_exponent);
}
{%- endif %}

/* A step as a part of the piece, in units of 2^-64{% if !floating %}: step 2^({{ 64 - fraction_bits }} - s), saturated{% endif %}. */
IN_PLACE uint64_t part_of(const piece_row *row, number step)
{
{%- if floating %}
    (void)row;
    return to_phase(step, 0);
{%- else if exponents.to_phase == ToPhase::WithinAWord %}
    /* No step is too long: it is moved by less than a word. */
    const uint32_t distance = 64u - FRACTION_BITS - (uint32_t)row->step_exponent;
    const uint32_t bits = (step > 0) ? (uint32_t)step : 0u;
    const uint32_t high = bits >> (32u - distance);
    const uint32_t low = bits << distance;
    return ((uint64_t)high << 32) | low;
{%- else if exponents.to_phase == ToPhase::BeyondAWord %}
    /* The step is a part of the first word alone. */
    const int32_t places = 32 - (int32_t)FRACTION_BITS - row->step_exponent;
    const uint32_t distance = (uint32_t)places;
    const uint32_t bits = (step > 0) ? (uint32_t)step : 0u;
    const uint32_t part = bits << distance;
    return ((part >> distance) == bits) ? ((uint64_t)part << 32) : UINT64_MAX;
{%- else %}
    return to_phase(step, -(int32_t)row->step_exponent);
{%- endif %}
}

/* One coordinate of N{% if rational %}, or W,{% endif %} about t, by repeated synthetic division with p (p + 1)/2 products: writes the coefficients c_1
 * to c_p of N(t + h) - N(t) = sum(c_k h^k), and returns N(t){% if rational %} without the constant{% endif %}. */
IN_PLACE number shift_coordinate(const number n[DEGREE], number t, number c[DEGREE])
{
    c[DEGREE - 1u] = n[DEGREE - 1u];
{%- if self.is_unrolled() %}
    /* The first sweep takes the coefficients from the table; each entry becomes the sum so far. */
{%- for k in (1..degree).rev() %}
    c[{{ k - 1 }}] = mul_add(c[{{ k }}], t, n[{{ k - 1 }}]);
{%- endfor %}
    const number value = mul_by(c[0], t);
{%- for low in 0..degree - 1 %}
    /* c_{{ low + 1 }} */
{%- for k in (low + 1..degree).rev() %}
    c[{{ k - 1 }}] = mul_add(c[{{ k }}], t, c[{{ k - 1 }}]);
{%- endfor %}
{%- endfor %}
{%- else %}
    /* The first sweep takes the coefficients from the table; each entry becomes the sum so far. */
    for (uint32_t k = DEGREE - 1u; k > 0u; k--) {
        c[k - 1u] = mul_add(c[k], t, n[k - 1u]);
    }
    const number value = mul_by(c[0], t);
    for (uint32_t low = 0u; low < (DEGREE - 1u); low++) {
        for (uint32_t k = DEGREE - 1u; k > low; k--) {
            c[k - 1u] = mul_add(c[k], t, c[k - 1u]);
        }
    }
{%- endif %}
    return value;
}
{%- if rational %}

/* Turns N and its derivatives about t into P and the chord's numerator, c_k - P omega_k, all over W(t). `turns` becomes
 * omega_k / W(t). */
IN_PLACE void divide_by_weight(uint32_t piece, number t, number rows[AXES][DEGREE], number offset[AXES], number turns[DEGREE])
{
    const number rise = shift_coordinate(&weights[piece][1], t, turns);
    const number reciprocal = divide(ONE, add(weights[piece][0], rise));
    for (uint32_t k = 0u; k < DEGREE; k++) {
        turns[k] = mul(turns[k], reciprocal);
    }
    for (uint32_t d = 0u; d < AXES; d++) {
        offset[d] = mul(offset[d], reciprocal);
        for (uint32_t k = 0u; k < DEGREE; k++) {
            rows[d][k] = rounded(plus(product(rows[d][k], reciprocal), product(negative(offset[d]), turns[k])));
        }
    }
}
{%- endif %}
{%- if !floating %}

/* The exponents of a piece: from h^k in units of 2^e mm to eta x^(k-1) in units of 2^-{{ chord_exponent }} mm, for k = 1 and what each
 * further k adds: h^k = x^k 2^(k (r - s)). */
IN_PLACE int32_t exponent_of_first(const piece_row *row)
{
    return (int32_t)row->coordinate_exponent - row->step_exponent{% if chord_exponent != 0 %} + {{ upper }}_CHORD_EXPONENT{% endif %};
}
{%- if degree > 1 || rational %}

IN_PLACE int32_t exponent_per_power(const piece_row *row)
{
    return (int32_t)row->range_exponent - row->step_exponent;
}
{%- endif %}
{%- endif %}

/* Writes the polynomials of the piece about t into `at`, which has those about another place of the same piece{% if !rational %}: the last
 * coefficient is the same everywhere{% endif %}. */
IN_PLACE void shift_along(uint32_t piece, const piece_row *row, number t, shifted *at)
{
    number rows[AXES][DEGREE];
{%- for d in 0..axes %}
    at->offset[{{ d }}] = shift_coordinate(numerators[piece][{{ d }}], t, rows[{{ d }}]);
{%- endfor %}
{%- if rational %}
    number turns[DEGREE];
    divide_by_weight(piece, t, rows, at->offset, turns);
{%- endif %}
{%- if floating || (degree == 1 && !rational) %}
    (void)row;
{%- else %}
    int32_t exponent = exponent_of_first(row);
{%- endif %}
{%- if self.is_unrolled() %}
{%- for scaling in exponents.powers %}
{%- let k = loop.index0 %}
{%- for d in 0..axes %}
    at->chord[{{ d }}][{{ k }}] = {% if floating %}rows[{{ d }}][{{ k }}]{% else %}{{ scaling }}(rows[{{ d }}][{{ k }}], exponent){% endif %};
{%- endfor %}
{%- if !floating && !loop.last %}
    exponent += exponent_per_power(row);
{%- endif %}
{%- endfor %}
{%- else %}
    for (uint32_t k = 0u; k < (DEGREE{% if !rational %} - 1u{% endif %}); k++) {
        for (uint32_t d = 0u; d < AXES; d++) {
            at->chord[d][k] = {% if floating %}rows[d][k]{% else %}times_power_of_two(rows[d][k], exponent){% endif %};
        }
{%- if !floating %}
        exponent += exponent_per_power(row);
{%- endif %}
    }
{%- endif %}
{%- if rational %}
{%- if floating %}
    for (uint32_t k = 0u; k < DEGREE; k++) {
        at->weight[k] = turns[k];
    }
{%- else %}
    exponent = 0;
    for (uint32_t k = 0u; k < DEGREE; k++) {
        exponent += exponent_per_power(row);
        at->weight[k] = times_power_of_two(turns[k], exponent);
    }
{%- endif %}
{%- endif %}
}

/* The same whatever `at` holds. */
static void shift_to(uint32_t piece, number t, shifted *at)
{
    const piece_row *row = &pieces[piece];
    shift_along(piece, row, t, at);
{%- if !rational %}
{%- if floating %}
{%- for d in 0..axes %}
    at->chord[{{ d }}][DEGREE - 1u] = numerators[piece][{{ d }}][DEGREE - 1u];
{%- endfor %}
{%- else %}
    const int32_t exponent = exponent_of_first(row){% if degree == 2 %} + exponent_per_power(row){% else if degree > 2 %} + ({{ degree - 1 }} * exponent_per_power(row)){% endif %};
    for (uint32_t d = 0u; d < AXES; d++) {
        at->chord[d][DEGREE - 1u] = times_power_of_two(numerators[piece][d][DEGREE - 1u], exponent);
    }
{%- endif %}
{%- endif %}
}

/* The offset of a piece's point in the units of setpoints. */
IN_PLACE void in_units_of_path(const piece_row *row, const number offset[AXES], number in_units[AXES])
{
{%- match exponents.to_path %}
{%- when Some(scaling) %}
    /* The path's unit is that of the piece with the largest. */
    const int32_t exponent = row->coordinate_exponent{% if coordinate_exponent != 0 %} - {{ upper }}_COORDINATE_EXPONENT{% endif %};
{%- for d in 0..axes %}
    in_units[{{ d }}] = {{ scaling }}(offset[{{ d }}], exponent);
{%- endfor %}
{%- when None %}
    (void)row;
{%- for d in 0..axes %}
    in_units[{{ d }}] = offset[{{ d }}];
{%- endfor %}
{%- endmatch %}
}

/* The phase at the end of a step on its piece; false past the end. */
IN_PLACE bool after(uint64_t *phase, uint64_t step)
{
    if (step >= ~*phase) {
        return false;
    }
    *phase += step;
    return true;
}

/* The place on a piece at the end of a step, as phase and as number; false past the end. */
IN_PLACE bool onward(const piece_row *row, uint64_t *phase, number *t, number step)
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
