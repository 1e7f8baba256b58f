/* The distance of each period: L = tau (v + change g), g being the mean of the stage's shape over the interval tau. */

#define PERIOD (UINT64_C(1) << 32)

/* half_units / (2 duration) as a phase, for half_units <= 2 duration. The time is doubled, so that the middle of an odd
 * interval is a whole number. */
static uint64_t fraction_of_stage(const stage_row *stage, uint64_t half_units)
{
    /* half_units 2^64 / duration = half_units reciprocal / 2^exponent */
    const two_words product = product_of_words(half_units, stage->reciprocal);
    const uint64_t shift = (uint64_t)stage->reciprocal_exponent + 1u; /* 1 to 62 */
    return (product.low >> shift) | (product.high << (64u - shift));
}

/* The same as a number, cut. */
static number share_of_stage(const stage_row *stage, uint64_t half_units)
{
{%- if floating %}
    return from_phase(fraction_of_stage(stage, half_units), 0);
{%- else %}
    return fraction(fraction_of_stage(stage, half_units));
{%- endif %}
}
{%- if uses.cosine %}

{% include "cosine.c" %}
{%- endif %}
{%- if uses.shapes %}

/* The mean of g over an interval about `middle`, both as shares of the stage. */
static number mean_of_shape(const stage_row *stage, number middle, number width)
{
{%- if uses.many_shapes %}
{%- for shape in shapes %}
    if (stage->shape == {{ shape.name }}) {
{% include "mean.c" %}
    }
{%- endfor %}
    return middle;
{%- else %}
{%- if !uses.bent %}
    (void)stage;
{%- endif %}
{%- for shape in shapes %}
{%- if shape.name == "STEADY" %}
    (void)width;
{%- endif %}
{% include "mean.c" %}
{%- endfor %}
{%- endif %}
}
{%- endif %}

/* The mean feed over an interval of this share of the stage about `middle`, a share too. */
static number mean_feed(const stage_row *stage, number middle, number share)
{
{%- if uses.shapes %}
    return mul_add(stage->change, mean_of_shape(stage, middle, share), stage->feed);
{%- else %}
    (void)middle;
    (void)share;
    return stage->feed;
{%- endif %}
}

/* The distance over `units` of 2^-32 periods of the schedule's time, at most one period; false if no time passes. */
static bool advance_by(uint32_t end, uint32_t *at_stage, uint64_t *time, uint64_t units, number *distance)
{
    uint64_t left = units;
    number length = {{ zero }};
    while (*at_stage < end) {
        const stage_row *stage = &stages[*at_stage];
        const uint64_t rest = (stage->duration > *time) ? (stage->duration - *time) : 0u;
        const uint64_t interval = (left < rest) ? left : rest;
        const number share = (interval == PERIOD) ? stage->period_share : share_of_stage(stage, 2u * interval);
        const number mean = mean_feed(stage, fraction(fraction_of_stage(stage, (2u * *time) + interval)), share);
        length = (interval == PERIOD) ? mean : mul_add(mean, fraction_of_period(interval), length);
        left -= interval;
        *time += interval;
        if (*time < stage->duration) {
            break;
        }
        (*at_stage)++;
        *time = 0u;
        if (left == 0u) {
            break;
        }
    }
    *distance = length;
    return left < units;
}

/* The distance of the period in which a stage ends. */
static bool advance_over_end(uint32_t end, uint32_t *at_stage, uint64_t *time, number *distance)
{
    const crossing_row *crossing = &crossings[*at_stage];
    const uint64_t rest = stages[*at_stage].duration - *time;
    if ((crossing->stages > 0u) && (rest == ((uint64_t)crossing->rest + 1u))) {
        *at_stage += crossing->stages;
        *time = crossing->time;
        *distance = crossing->distance;
        return true;
    }
    return advance_by(end, at_stage, time, PERIOD, distance);
}
{%- if uses.shapes %}

/* fraction(fraction_of_stage()) in a stage that is longer than a period{% if word_bits < 64 %}: its first digits are those of the product{% endif %}. */
IN_PLACE number place_in_stage(const stage_row *stage, uint64_t half_units)
{
{%- if word_bits == 64 %}
    return fraction(fraction_of_stage(stage, half_units));
{%- else %}
    const two_words product = product_of_words(half_units, stage->reciprocal);
{%- if floating %}
    const uint64_t leading = product.high >> ((uint32_t)stage->reciprocal_exponent - 31u);
    return (number)(uint32_t)leading * {{ words.fraction_unit }};
{%- else %}
    const uint64_t bits = product.high >> ((uint32_t)stage->reciprocal_exponent + 1u - FRACTION_BITS);
    return (number)(word)bits;
{%- endif %}
{%- endif %}
}
{%- endif %}

/* The distance of the next period; false when the schedule is over. */
IN_PLACE bool advance(uint32_t end, uint32_t *at_stage, uint64_t *time, number *distance)
{
    if (*at_stage >= end) {
        return false;
    }
    const stage_row *stage = &stages[*at_stage];
    const uint64_t begin = *time;
    const uint64_t next = begin + PERIOD;
    if (next >= stage->duration) {
        return advance_over_end(end, at_stage, time, distance);
    }
    /* Wholly inside one stage, as most periods are. */
    *time = next;
{%- if uses.shapes %}
    if (stage->change != {{ zero }}) {
        *distance = mean_feed(stage, place_in_stage(stage, begin + next), stage->period_share);
        return true;
    }
{%- endif %}
    *distance = stage->feed;
    return true;
}
