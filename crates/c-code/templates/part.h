/* Part: {{ about }}
 *
 * Written by `feedbits compile --language c`, version {{ version }}; edited by nobody.
{%- if let Some(fault) = fault %}
 *
 * {{ fault }}
{%- endif %}
 *
 * A controller calls, a setpoint a period:
 *
 *     for (uint32_t section = 0u; section < {{ upper }}_SECTIONS; section++) {
 *         {{ name }}_start(&state, section);                    before the section's first period
{%- if overrides %}
 *         while ({{ name }}_step_overridden(&state, &rates, &setpoint)) {
{%- else %}
 *         while ({{ name }}_step(&state, &setpoint)) {          once a period
{%- endif %}
 *             {{ name }}_position(&setpoint, position);         to the axes, in 2^-39 mm
 *         }
 *     }
 *
 * Between two sections the machine stands. Where a section begins elsewhere than the one before it ends, the part has a
 * rapid move or a gap: the controller goes there by itself. A section may begin at any later time.
{%- if overrides %}
 *
 * Feed override and hold: {{ name }}_set_rate() asks for a share of the plan's speed, which the run then approaches within
 * the machine's acceleration and jerk. The rate 0 is hold: the run has come to a stop where {{ name }}_is_settled() says so,
 * and goes on when a rate above 0 is asked for. The rates go with the controller from section to section.
{%- endif %}
 *
 * To abort, call no more: nothing is held but *state, and {{ name }}_start() begins any section anew. The drives then need a
 * ramp of their own, for a run that is cut off has not slowed down.{% if !overrides %} For a stop on the path within the limits, compile with
 * --feed-override.{% endif %}
 *
 * Real time takes no heap, no library and no recursion, and every loop in it has a bound. {{ name }}_start() solves a chord
 * and may take longer than a period's step. All functions may be called from an interrupt; two calls with the same
 * *state must not overlap. What is constant lies in {{ table_bytes }} bytes of tables.
 *
 * Numbers are {{ format }}: {{ format_words }}.
 */
#ifndef {{ upper }}_H
#define {{ upper }}_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The version of feedbits that wrote these files. */
#define {{ upper }}_FEEDBITS_VERSION "{{ version }}"

/** The version of the tables' layout. {{ name }}.c is compiled only beside a header of the same. */
#define {{ upper }}_LAYOUT {{ layout }}

/** T, the interpolation period, in nanoseconds, rounded. */
#define {{ upper }}_PERIOD_NS {{ period_ns }}ULL

/** Sections from stop to stop. */
#define {{ upper }}_SECTIONS {{ sections.len() }}u

/** Setpoints from begin to end{% if overrides %}, at the plan's own speed{% endif %}. */
#define {{ upper }}_PERIODS UINT32_C({{ periods }})

/** The checksum of all setpoints' positions; {{ name }}_checksum() has the formula. */
#define {{ upper }}_CHECKSUM {{ "{:#018x}"|format(checksum) }}ULL
{%- if let Some(run) = overridden %}

/** Setpoints and checksum of the self-test's run with feed override. */
#define {{ upper }}_PERIODS_OVERRIDDEN UINT32_C({{ run.periods }})
#define {{ upper }}_CHECKSUM_OVERRIDDEN {{ "{:#018x}"|format(run.checksum) }}ULL
{%- endif %}

/** Coordinates of a setpoint: x, y{% if axes == 3 %}, z{% endif %}. */
#define {{ upper }}_AXES {{ axes }}u

/** p, the degree of all pieces. */
#define {{ upper }}_DEGREE {{ degree }}u

/** A setpoint's offset is in units of 2^this mm. */
#define {{ upper }}_COORDINATE_EXPONENT ({{ coordinate_exponent }})

/** Lengths of chords are in units of 2^-this mm. */
#define {{ upper }}_CHORD_EXPONENT ({{ chord_exponent }})

/** A number in {{ format }}: {{ format_words }}. */
typedef {{ number_type }} {{ name }}_number;

/** The polynomials of the present piece about the place t where the next step begins. */
typedef struct {
    /** q_k for k = 1 to p: the chord over a step eta is `eta sum(q_k x^(k-1))`{% if rational %} over `1 + sum(weight_k x^k)`{% endif %}. */
    {{ name }}_number chord[{{ upper }}_AXES][{{ upper }}_DEGREE];
{%- if rational %}
    {{ name }}_number weight[{{ upper }}_DEGREE];
{%- endif %}
    /** The point at t, from the piece's origin, in the piece's own units. */
    {{ name }}_number offset[{{ upper }}_AXES];
} {{ name }}_shifted;

/** All that changes from period to period. A caller reads and writes nothing of it. */
typedef struct {
    /** Time since the begin of the stage, in 2^-32 periods. */
    uint64_t time;
    /** Place on the piece, in units of 2^-64, and the same as a number. */
    uint64_t phase;
    {{ name }}_number t;
{%- if !floating %}
    /** 2^s of the piece: the step over all of it. */
    {{ name }}_number whole;
{%- endif %}
    /** Steps per chord: sigma of the last step, its rise in that step, and how much less the next is expected to be. */
    {{ name }}_number newest;
    {{ name }}_number rise;
    {{ name }}_number fall;
    {{ name }}_shifted at;
    uint32_t stage;
    uint32_t piece;
    uint32_t section;
} {{ name }}_state;

/** One period. */
typedef struct {
    /** The piece from whose origin `offset` counts. */
    uint32_t piece;
    /** The place on it, in units of 2^-64; 0 at the end of a section, which is the end of its last piece. */
    uint64_t phase;
    /** In units of 2^{{ upper }}_COORDINATE_EXPONENT mm. */
    {{ name }}_number offset[{{ upper }}_AXES];
    /** The chord of the period, in units of 2^-{{ upper }}_CHORD_EXPONENT mm. */
    {{ name }}_number length;
    /** How often the chord was evaluated. */
    uint32_t evaluations;
} {{ name }}_setpoint;
{%- if overrides %}

/** The share of the plan's own speed at which the run goes. A caller reads and writes nothing of it. */
typedef struct {
    /** The share and the one that is asked for, in units of 2^-32, and the change a period. */
    uint64_t rate;
    uint64_t target;
    int64_t slope;
    /** The landing behind the plan's end: periods since then, those of a quarter, the weights and the pause to come. */
    int32_t period;
    int32_t quarter;
    int32_t weight;
    int32_t pause_left;
} {{ name }}_rates;

/** The plan's own speed, which is that of the highest override, and the speed of the commanded feed, 100 %. */
#define {{ upper }}_FULL_RATE 0x100000000ULL
#define {{ upper }}_COMMANDED_RATE {{ feeds.commanded }}ULL
{%- endif %}

/** What a self-test finds. */
typedef enum {
    /** Every setpoint is bit for bit the one that was judged. */
    {{ upper }}_GOOD = 0,
    /** The compiler fuses products and sums: build with -ffp-contract=off. */
    {{ upper }}_CONTRACTS = 1,
    /** The run differs. */
    {{ upper }}_DIFFERS = 2{% if overrides %},
    /** The run with feed override differs. */
    {{ upper }}_DIFFERS_OVERRIDDEN = 3{% endif %}
} {{ name }}_verdict;

/** Sets the state to the begin of a section, at rest. A section that does not exist is the last one. */
void {{ name }}_start({{ name }}_state *state, uint32_t section);

/** The next setpoint; false once the section's end has been commanded and its schedule is over. Call it once a period. */
bool {{ name }}_step({{ name }}_state *state, {{ name }}_setpoint *setpoint);
{%- if overrides %}

/** Sets the rate to 100 %, the commanded feed. Call it once, before the first section. */
void {{ name }}_start_rates({{ name }}_rates *rates);

/** Asks for another rate, in units of 2^-32: 0 is hold, {{ upper }}_FULL_RATE and more are the plan's own speed. */
void {{ name }}_set_rate({{ name }}_rates *rates, uint64_t target);

/** Whether the rate is the one that was asked for. */
bool {{ name }}_is_settled(const {{ name }}_rates *rates);

/** {{ name }}_step() at the present rate. A slower run comes to its stop later, and lands there within the limits. */
bool {{ name }}_step_overridden({{ name }}_state *state, {{ name }}_rates *rates, {{ name }}_setpoint *setpoint);
{%- endif %}

/** The position of a setpoint, in units of 2^-39 mm: origin plus offset. */
void {{ name }}_position(const {{ name }}_setpoint *setpoint, int64_t position[{{ upper }}_AXES]);

/** The checksum `before`, and another position: for each coordinate `h = (h ^ word) * 0x100000001b3; h = h ^ (h >> 32)`,
 * modulo 2^64. It begins with 0xcbf29ce484222325. */
uint64_t {{ name }}_checksum(uint64_t before, const int64_t position[{{ upper }}_AXES]);

/** Runs the part and compares the checksum: {{ periods }} periods as fast as the processor makes them. */
{{ name }}_verdict {{ name }}_self_test(void);

#ifdef __cplusplus
}
#endif

#endif
