/* The self-test. */

uint64_t {{ name }}_checksum(uint64_t before, const int64_t position[AXES])
{
    uint64_t sum = before;
    for (uint32_t d = 0u; d < AXES; d++) {
        sum = (sum ^ (uint64_t)position[d]) * 0x100000001b3ULL;
        sum ^= sum >> 32;
    }
    return sum;
}
{%- if floating %}

/* Whether the compiler fuses a product and a sum: (1 + 2^-k)(1 - 2^-k) - 1 is 0 if the product is rounded, else -2^(-2k). */
static bool contracts(void)
{
    volatile number above = ONE + RESOLUTION;
    volatile number below = ONE - RESOLUTION;
    volatile number less = -ONE;
    return mul_add(above, below, less) < {{ zero }};
}
{%- endif %}

{{ name }}_verdict {{ name }}_self_test(void)
{
    {{ name }}_state state;
    {{ name }}_setpoint setpoint;
    int64_t position[AXES];
    uint64_t checksum = 0xcbf29ce484222325ULL;
    uint32_t periods = 0u;
{%- if floating %}
    if (contracts()) {
        return {{ upper }}_CONTRACTS;
    }
{%- endif %}
    for (uint32_t section = 0u; section < {{ upper }}_SECTIONS; section++) {
        {{ name }}_start(&state, section);
        while ((periods <= {{ upper }}_PERIODS) && {{ name }}_step(&state, &setpoint)) {
            {{ name }}_position(&setpoint, position);
            checksum = {{ name }}_checksum(checksum, position);
            periods++;
        }
    }
    if ((periods != {{ upper }}_PERIODS) || (checksum != {{ upper }}_CHECKSUM)) {
        return {{ upper }}_DIFFERS;
    }
{%- if let Some(run) = overridden %}
    /* The same at changing rates: slower, held, and on again. */
    {{ name }}_rates rates;
    checksum = 0xcbf29ce484222325ULL;
    periods = 0u;
    {{ name }}_start_rates(&rates);
    for (uint32_t section = 0u; section < {{ upper }}_SECTIONS; section++) {
        {{ name }}_start(&state, section);
        while ((periods <= {{ upper }}_PERIODS_OVERRIDDEN) && {{ name }}_step_overridden(&state, &rates, &setpoint)) {
            {{ name }}_position(&setpoint, position);
            checksum = {{ name }}_checksum(checksum, position);
            periods++;
{%- for command in run.commands %}
            {% if !loop.first %}} else {% endif %}if (periods == {{ command.period }}u) {
                {{ name }}_set_rate(&rates, {{ command.rate() }}ULL);
{%- endfor %}
            } else {
                /* The rate stays as it is. */
            }
        }
    }
    if ((periods != {{ upper }}_PERIODS_OVERRIDDEN) || (checksum != {{ upper }}_CHECKSUM_OVERRIDDEN)) {
        return {{ upper }}_DIFFERS_OVERRIDDEN;
    }
{%- endif %}
    return {{ upper }}_GOOD;
}
