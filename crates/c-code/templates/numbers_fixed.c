/* Numbers: {{ format }}, a word of {{ word_bits }} bits that stands for word / 2^{{ fraction_bits }}.
 *
 * Sums are exact and wrap. Products and sums of products are formed in a word of twice the width, which wraps too, and
 * rounded once, to nearest with ties up. Quotients and roots are rounded to nearest and saturate. The tables are compiled so
 * that no sum or product of a run needs to wrap. */

typedef {{ words.unsigned }} word;
typedef {{ words.wide }} wide;

#define WORD_BITS {{ word_bits }}u
#define FRACTION_BITS {{ fraction_bits }}u
#define NUMBER_MAX {{ max }}
#define NUMBER_MIN (-NUMBER_MAX - 1)
#define ONE {{ one }}
#define RESOLUTION ((number)1)

/* The number of these bits; their sign is the first. */
static number of_bits(word bits)
{
    return (number)bits;
}

static number add(number a, number b)
{
    return of_bits((word)((word)a + (word)b));
}

static number sub(number a, number b)
{
    return of_bits((word)((word)a - (word)b));
}

static number negative(number a)
{
    return sub(0, a);
}

/* a / 2^distance, cut toward minus infinity. */
static number shifted_right(number a, uint32_t distance)
{
    /* cppcheck-suppress misra-c2012-10.1 ; a shift of a signed word, whose meaning is checked at the top of the file */
    return (number)(a >> distance);
}

/* a b, exactly, in units of 2^-{{ 2 * fraction_bits }}. */
static wide product(number a, number b)
{
{%- if word_bits == 32 %}
#if FEEDBITS_SHORT_PRODUCTS
    /* The first half of a word has the sign. */
    const number a_high = shifted_right(a, 16u);
    const number b_high = shifted_right(b, 16u);
    const word a_low = (word)a & UINT16_MAX;
    const word b_low = (word)b & UINT16_MAX;
    const word low = a_low * b_low;
    const word middle = ((word)a_high * b_low) + (low >> 16);
    const word other = (a_low * (word)b_high) + (middle & UINT16_MAX);
    const number carried = shifted_right(of_bits(middle), 16u);
    const word high = ((word)a_high * (word)b_high) + (word)carried + (word)shifted_right(of_bits(other), 16u);
    return ((wide)high << 32) | ((other << 16) | (low & UINT16_MAX));
#else
{%- endif %}
    const {{ words.signed_wide }} exact = ({{ words.signed_wide }})a * ({{ words.signed_wide }})b;
    return (wide)exact;
{%- if word_bits == 32 %}
#endif
{%- endif %}
}

static wide plus(wide a, wide b)
{
    return a + b;
}

/* A sum of products as a number: to nearest, ties up. */
static number rounded(wide sum)
{
{%- if fraction_bits == 0 %}
    return of_bits((word)sum);
{%- else if word_bits == 32 %}
    /* The first bit behind the last place says whether to round up. */
    const word high = (word)(sum >> 32);
    const word low = (word)sum;
    return of_bits((high << (32u - FRACTION_BITS)) + (low >> FRACTION_BITS) + ((low >> (FRACTION_BITS - 1u)) & 1u));
{%- else %}
    return of_bits((word)((sum + ((wide)1 << (FRACTION_BITS - 1u))) >> FRACTION_BITS));
{%- endif %}
}

static number mul(number a, number b)
{
    return rounded(product(a, b));
}

/* The same for a factor between -2 and 2, as t, x and shares are. */
static number mul_by(number a, number factor)
{
{%- if self.splits_factors() %}
#if FEEDBITS_SHORT_PRODUCTS
    /* (a_1 2^16 + a_0)(f_1 2^14 + f_0) = 2^16 (a_1 f_1 2^14 + a_1 f_0 + (a_0 f_1 + a_0 f_0 / 2^14) / 4): cut in this way, what is
     * below 2^16 is not needed, and nothing passes 32 bits. */
    const number a_high = shifted_right(a, 16u);
    const word a_low = (word)a & UINT16_MAX;
    const number high = shifted_right(factor, 14u);
    const word low = (word)factor & 0x3fffu;
    const word behind = (a_low * (word)high) + ((a_low * low) >> 14);
    const word middle = ((word)a_high * low) + (word)shifted_right(of_bits(behind), 2u) + ((word)1 << (FRACTION_BITS - 17u));
    return of_bits((((word)a_high * (word)high) << (30u - FRACTION_BITS)) + (word)shifted_right(of_bits(middle), FRACTION_BITS - 16u));
#else
    return mul(a, factor);
#endif
{%- else %}
    return mul(a, factor);
{%- endif %}
}

/* a factor + b, rounded once: b has no digits behind the last place. The factor is between -2 and 2. */
static number mul_add(number a, number factor, number b)
{
    return add(mul_by(a, factor), b);
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

{% if word_bits < 64 -%}
/* |a| as a word of twice the width. */
static wide magnitude(number a)
{
    return (a < 0) ? (wide)(-({{ words.signed_wide }})a) : (wide)a;
}

/* The number of a magnitude and a sign; saturates. */
static number with_sign(wide size, bool is_negative)
{
    if (is_negative) {
        return (size > (wide)NUMBER_MAX) ? (number)NUMBER_MIN : negative((number)size);
    }
    return (size > (wide)NUMBER_MAX) ? (number)NUMBER_MAX : (number)size;
}

/* a / b, ties away from zero; over zero the extreme with the sign of a, and 0/0 is 0. */
static number divide(number a, number b)
{
    const wide n = magnitude(a) << FRACTION_BITS;
    const wide d = magnitude(b);
    wide quotient;
    if ((n >> WORD_BITS) < d) {
        quotient = n / d;
        const word rest = (word)((word)n - (word)((word)quotient * (word)d));
        if (rest >= (d - rest)) {
            quotient++;
        }
    } else {
        quotient = (n == 0u) ? 0u : {{ words.wide_max }};
    }
    return with_sign(quotient, (a < 0) != (b < 0));
}

{% if word_bits == 32 -%}
/* The root of an integer on the way: of the first pairs of its bits, and what is left of them. */
typedef struct {
    word root;
    word rest;
} partial_root;

/* Goes on with the first `pairs` of these bits: a pair gives a bit of the root. */
static void take_pairs(partial_root *so_far, word bits, uint32_t pairs)
{
    word root = so_far->root;
    word rest = so_far->rest;
    word left = bits;
    for (uint32_t pair = 0u; pair < pairs; pair++) {
        const word trial = (root << 2) | 1u;
        rest = (rest << 2) | (left >> 30);
        left <<= 2;
        root <<= 1;
        if (rest >= trial) {
            rest -= trial;
            root++;
        }
    }
    so_far->root = root;
    so_far->rest = rest;
}

/* The length of a vector, sqrt(sum(v^2)), to nearest; saturates. */
static number norm(const number vector[AXES])
{
    wide sum = 0u;
    for (uint32_t d = 0u; d < AXES; d++) {
        sum += product(vector[d], vector[d]);
    }
    const word high = (word)(sum >> WORD_BITS);
    const word low = (word)sum;
    if (high >= ((word)1 << (WORD_BITS - 2u))) {
        return NUMBER_MAX;
    }
    /* A root of 31 bits leaves a rest of 32. Only the last pair takes more. */
    partial_root found;
    found.root = 0u;
    found.rest = 0u;
    take_pairs(&found, high, 16u);
    take_pairs(&found, low, 15u);
    wide rest = ((wide)found.rest << 2) | (low & 3u);
    wide root = (wide)found.root << 1;
    if (rest > (2u * root)) {
        rest -= (2u * root) + 1u;
        root++;
    }
    /* (k + 1/2)^2 = k^2 + k + 1/4: from a rest above k on, k + 1 is nearer. */
    return with_sign((rest > root) ? (root + 1u) : root, false);
}
{%- else -%}
/* The length of a vector, sqrt(sum(v^2)), to nearest; saturates. */
static number norm(const number vector[AXES])
{
    wide rest = 0u;
    for (uint32_t d = 0u; d < AXES; d++) {
        rest += product(vector[d], vector[d]);
    }
    /* The root of the integer, bit by bit: `root` is twice the root so far, times the place of the bit. */
    wide root = 0u;
    for (wide bit = (wide)1 << {{ words.root_shift }}; bit != 0u; bit >>= 2) {
        if (rest >= (root + bit)) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    /* (k + 1/2)^2 = k^2 + k + 1/4: from a rest above k on, k + 1 is nearer. */
    return with_sign((rest > root) ? (root + 1u) : root, false);
}
{%- endif %}
{%- endif %}

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
    const uint64_t bits = units >> (32u - FRACTION_BITS);
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
    return (bits > (uint64_t)NUMBER_MAX) ? (number)NUMBER_MAX : (number)bits;
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
