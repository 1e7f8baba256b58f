/* Part: {{ about }}
 *
 * Written by `feedbits compile --language c`, version {{ version }}; edited by nobody. {{ name }}.h says how it is used.
 *
 * Names and formulas are those of the Rust kernels: crates real, nurbs-core and secant-interp.
 */
#include "{{ name }}.h"

#if {{ upper }}_LAYOUT != {{ layout }}
#define TEXT(a) #a
#define TEXT_OF(a) TEXT(a)
#pragma message("{{ name }}.h is of layout " TEXT_OF({{ upper }}_LAYOUT) ", the tables of {{ name }}.c are of layout {{ layout }}")
#error "{{ name }}.h and {{ name }}.c are of different layouts: take both files of one run of feedbits compile"
#endif
{%- if floating %}

#include <float.h>
{%- endif %}

/* What this file takes for granted of a compiler beyond C99: two's complement, conversions to signed words that wrap, and
 * right shifts of signed words that keep the sign. All compilers for controllers do so; one that does not stops here. */
typedef char wraps_on_conversion[((int32_t)UINT32_C(0xffffffff) == -1) ? 1 : -1];
typedef char shifts_keep_the_sign[((-1 >> 1) == -1) ? 1 : -1];

#define AXES {{ upper }}_AXES
#define DEGREE {{ upper }}_DEGREE

typedef {{ name }}_number number;
typedef {{ name }}_shifted shifted;

{% include "products.c" %}

{% if floating -%}
{% include "numbers_float.c" %}
{%- else if word_bits == 64 -%}
{% include "numbers_fixed_64.c" %}
{%- else -%}
{% include "numbers_fixed.c" %}
{%- endif %}

{% include "tables.c" %}

{% include "lengths.c" %}

{% include "pieces.c" %}

{% include "chord.c" %}

{% include "joints.c" %}

{% include "step.c" %}
{%- if overrides %}

{% include "override.c" %}
{%- endif %}

{% include "self_test.c" %}
