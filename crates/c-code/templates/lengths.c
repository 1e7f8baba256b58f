/* The distance of each period: L = tau (v + change g), g being the mean of the stage's shape over the interval tau. */

#define PERIOD (UINT64_C(1) << 32)

/* half_units / (2 duration) as a phase, for half_units <= 2 duration. The time is doubled, so that the middle of an odd
 * interval is a whole number. */
static uint64_t fraction_of_stage(const stage_row *stage, uint64_t half_units)
{
    /* half_units 2^64 / duration = half_units reciprocal / 2^exponent, from four products of 32 bits. */
    const uint64_t a_low = half_units & UINT32_MAX;
    const uint64_t a_high = half_units >> 32;
    const uint64_t b_low = stage->reciprocal & UINT32_MAX;
    const uint64_t b_high = stage->reciprocal >> 32;
    const uint64_t low = a_low * b_low;
    const uint64_t cross_one = (a_high * b_low) + (low >> 32);
    const uint64_t cross_two = (a_low * b_high) + (cross_one & UINT32_MAX);
    const uint64_t product_high = (a_high * b_high) + (cross_one >> 32) + (cross_two >> 32);
    const uint64_t product_low = (cross_two << 32) | (low & UINT32_MAX);
    const uint64_t shift = (uint64_t)stage->reciprocal_exponent + 1u; /* 1 to 62 */
    return (product_low >> shift) | (product_high << (64u - shift));
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

/* The mean feed over an interval of this share of the stage; `middle` is the interval's, in half units. */
static number mean_feed(const stage_row *stage, uint64_t middle, number share)
{
{%- if uses.shapes %}
    if (stage->change == {{ zero }}) {
        return stage->feed;
    }
    return mul_add(stage->change, mean_of_shape(stage, fraction(fraction_of_stage(stage, middle)), share), stage->feed);
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
        const number share = (interval == PERIOD) ? stage->period_share : {% if floating %}from_phase(fraction_of_stage(stage, 2u * interval), 0){% else %}fraction(fraction_of_stage(stage, 2u * interval)){% endif %};
        const number mean = mean_feed(stage, (2u * *time) + interval, share);
        length = (interval == PERIOD) ? mean : mul_add(mean, from_phase(interval, 32), length);
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

/* The distance of the next period; false when the schedule is over. */
static bool advance(uint32_t end, uint32_t *at_stage, uint64_t *time, number *distance)
{
    if (*at_stage >= end) {
        return false;
    }
    const stage_row *stage = &stages[*at_stage];
    const uint64_t next = *time + PERIOD;
    if (next < stage->duration) {
        /* Wholly inside one stage, as most periods are. */
        *distance = mean_feed(stage, *time + next, stage->period_share);
        *time = next;
        return true;
    }
    return advance_by(end, at_stage, time, PERIOD, distance);
}
