/* Numbers: {{ format }}, a word of 64 bits that stands for word / 2^{{ fraction_bits }}.
 *
 * Sums are exact and wrap. Products and sums of products are formed in 128 bits, which wrap too, and rounded once, to
 * nearest with ties up. Quotients and roots are rounded to nearest and saturate. The tables are compiled so that no sum or
 * product of a run needs to wrap. */

typedef uint64_t word;

typedef two_words wide;
{% if uses.far_shifts %}
#define WORD_BITS 64u
{%- endif %}
#define FRACTION_BITS {{ fraction_bits }}u
#define NUMBER_MAX INT64_MAX
#define NUMBER_MIN (-NUMBER_MAX - 1)
#define ONE {{ one }}
#define RESOLUTION INT64_C(1)

/* The number of these bits; their sign is the first. */
static number of_bits(word bits)
{
    return (number)bits;
}

static number add(number a, number b)
{
    return of_bits((word)a + (word)b);
}

static number sub(number a, number b)
{
    return of_bits((word)a - (word)b);
}

static number negative(number a)
{
    return sub(0, a);
}

/* |a|; of the least number itself. */
static number absolute(number a)
{
    return (a < 0) ? negative(a) : a;
}

/* |a| <= limit, for any a but the least number. */
static bool is_at_most(number a, number limit)
{
    return (word)((word)a + (word)limit) <= (word)((word)limit + (word)limit);
}

static number minimum(number a, number b)
{
    return (b < a) ? b : a;
}

static number maximum(number a, number b)
{
    return (b > a) ? b : a;
}

static wide plus(wide a, wide b)
{
    wide sum;
    sum.low = a.low + b.low;
    sum.high = a.high + b.high + ((sum.low < a.low) ? 1u : 0u);
    return sum;
}

static wide minus(wide a, wide b)
{
    wide rest;
    rest.low = a.low - b.low;
    rest.high = a.high - b.high - ((a.low < b.low) ? 1u : 0u);
    return rest;
}

/* a b, exactly, in units of 2^-{{ 2 * fraction_bits }}. */
static wide product(number a, number b)
{
    wide result = product_of_words((word)a, (word)b);
    /* That is the product of the words without sign. A negative word counts 2^64 too much. */
    result.high -= (a < 0) ? (word)b : 0u;
    result.high -= (b < 0) ? (word)a : 0u;
    return result;
}

/* a sum of products as a number: to nearest, ties up. */
static number rounded(wide sum)
{
{%- if fraction_bits == 0 %}
    return of_bits(sum.low);
{%- else %}
    const wide half_unit = { 0u, UINT64_C(1) << (FRACTION_BITS - 1u) };
    const wide raised = plus(sum, half_unit);
    return of_bits((raised.low >> FRACTION_BITS) | (raised.high << (64u - FRACTION_BITS)));
{%- endif %}
}

static number mul(number a, number b)
{
    return rounded(product(a, b));
}

/* The same for a factor between -2 and 2, as t, x and shares are. */
static number mul_by(number a, number factor)
{
    return mul(a, factor);
}

/* a factor + b, rounded once: b has no digits behind the last place. */
static number mul_add(number a, number factor, number b)
{
    return add(mul(a, factor), b);
}

/* a / 2^distance, cut toward minus infinity. */
static number shifted_right(number a, uint32_t distance)
{
    /* cppcheck-suppress misra-c2012-10.1 ; a shift of a signed word, whose meaning is checked at the top of the file */
    return (number)(a >> distance);
}

/* a / 2^distance, to nearest, ties up. */
static number divided_by_power_of_two(number a, uint32_t distance)
{
{%- if uses.far_shifts %}
    if (distance >= WORD_BITS) {
        return 0; /* at most half a unit is left: ties up from -1/2 */
    }
{%- endif %}
    if (distance == 0u) {
        return a;
    }
    /* The last bit dropped says whether to round up. */
    const number twice = shifted_right(a, distance - 1u);
    return add(shifted_right(twice, 1u), of_bits((word)twice & 1u));
}

/* a 2^exponent: to the left the first bits are lost, to the right it rounds to nearest, ties up.
{%- if !uses.far_shifts %} No exponent of the
 * tables has the width of a word. */
{%- else %} */
{%- endif %}
static number times_power_of_two(number a, int32_t exponent)
{
    if (exponent < 0) {
        return divided_by_power_of_two(a, (uint32_t)-exponent);
    }
{%- if uses.far_shifts %}
    if (exponent >= (int32_t)WORD_BITS) {
        return 0;
    }
{%- endif %}
    return of_bits((word)((word)a << (uint32_t)exponent));
}

{% include "exponents.c" %}

static word magnitude(number a)
{
    return (a < 0) ? (0u - (word)a) : (word)a;
}

/* The number of a magnitude and a sign; saturates. */
static number with_sign(word size, bool is_negative)
{
    if (is_negative) {
        return (size > (word)NUMBER_MAX) ? NUMBER_MIN : -(number)size;
    }
    return (size > (word)NUMBER_MAX) ? NUMBER_MAX : (number)size;
}

static bool is_less(wide a, wide b)
{
    return (a.high < b.high) || ((a.high == b.high) && (a.low < b.low));
}

/* a / b, ties away from zero; over zero the extreme with the sign of a, and 0/0 is 0. */
static number divide(number a, number b)
{
    const word d = magnitude(b);
    const word n = magnitude(a);
{%- if fraction_bits == 0 %}
    word rest = 0u;
{%- else %}
    word rest = n >> (64u - FRACTION_BITS);
{%- endif %}
    word low = n << FRACTION_BITS;
    word quotient = 0u;
    if (rest < d) {
        /* Long division, a bit of the quotient each time. */
        for (uint32_t bit = 0u; bit < 64u; bit++) {
            const bool is_long = (rest >> 63) != 0u;
            rest = (rest << 1) | (low >> 63);
            low <<= 1;
            quotient <<= 1;
            if (is_long || (rest >= d)) {
                rest -= d;
                quotient |= 1u;
            }
        }
        if ((rest >= (d - rest)) && (quotient != UINT64_MAX)) {
            quotient++;
        }
    } else {
        quotient = (n == 0u) ? 0u : UINT64_MAX;
    }
    return with_sign(quotient, (a < 0) != (b < 0));
}

/* The length of a vector, sqrt(sum(v^2)), to nearest; saturates. */
static number norm(const number vector[AXES])
{
    wide rest = { 0u, 0u };
    for (uint32_t d = 0u; d < AXES; d++) {
        rest = plus(rest, product(vector[d], vector[d])); /* below 3 * 2^126 */
    }
    /* The root of the integer, bit by bit: `root` is twice the root so far, times the place of the bit. */
    wide root = { 0u, 0u };
    wide bit = { UINT64_C(1) << 62, 0u };
    for (uint32_t place = 0u; place < 64u; place++) {
        const wide trial = plus(root, bit);
        root.low = (root.low >> 1) | (root.high << 63);
        root.high >>= 1;
        if (!is_less(rest, trial)) {
            rest = minus(rest, trial);
            root = plus(root, bit);
        }
        bit.low = (bit.low >> 2) | (bit.high << 62);
        bit.high >>= 2;
    }
    /* (k + 1/2)^2 = k^2 + k + 1/4: from a rest above k on, k + 1 is nearer. k is below 2^64. */
    const bool is_up = is_less(root, rest) && (root.low != UINT64_MAX);
    return with_sign(is_up ? (root.low + 1u) : root.low, false);
}

/* phase / 2^64, cut to the format's bits. */
static number fraction(uint64_t phase)
{
{%- if fraction_bits == 0 %}
    (void)phase;
    return 0;
{%- else %}
    const uint64_t bits = phase >> (64u - FRACTION_BITS);
    return (number)bits;
{%- endif %}
}

/* units / 2^32, cut, for less than one. */
static number fraction_of_period(uint64_t units)
{
{%- if fraction_bits > 32 %}
    const uint64_t bits = units << (FRACTION_BITS - 32u);
{%- else %}
    const uint64_t bits = units >> (32u - FRACTION_BITS);
{%- endif %}
    return (number)bits;
}

/* phase 2^(exponent - 64), cut; saturates. */
static number from_phase(uint64_t phase, int32_t exponent)
{
    const int32_t left = exponent + (int32_t)FRACTION_BITS - 64;
    const int32_t places = (left < 0) ? -left : left;
    const uint32_t distance = (uint32_t)places;
    uint64_t bits = 0u;
    if (distance >= 64u) {
        bits = ((left > 0) && (phase != 0u)) ? UINT64_MAX : 0u;
    } else if (left > 0) {
        const uint64_t raised = phase << distance;
        bits = ((raised >> distance) == phase) ? raised : UINT64_MAX;
    } else {
        bits = phase >> distance;
    }
    return (bits > (uint64_t)NUMBER_MAX) ? NUMBER_MAX : (number)bits;
}

/* a 2^(64 + exponent) as an integer, cut; 0 for a negative number; saturates. */
static uint64_t to_phase(number a, int32_t exponent)
{
    const int32_t left = 64 - (int32_t)FRACTION_BITS + exponent;
    const int32_t places = (left < 0) ? -left : left;
    const uint32_t distance = (uint32_t)places;
    if (a <= 0) {
        return 0u;
    }
    const uint64_t bits = (uint64_t)a;
    if (distance >= 64u) {
        return (left > 0) ? UINT64_MAX : 0u;
    }
    if (left < 0) {
        return bits >> distance;
    }
    const uint64_t raised = bits << distance;
    return ((raised >> distance) == bits) ? raised : UINT64_MAX;
}

/* 2^exponent, or the greatest number if that is less. */
static number power_of_two(int32_t exponent)
{
    return from_phase(UINT64_C(1) << 63, exponent + 1);
}
