/* Numbers: {{ format }}, with every operation rounded on its own, as IEEE 754 says. */
#include <float.h>

#if defined(__FAST_MATH__)
#error "compile without -ffast-math: the run would not be the one that was judged"
#endif
#if !defined(FLT_EVAL_METHOD) || ((FLT_EVAL_METHOD != 0) && (FLT_EVAL_METHOD != 1))
#error "the compiler computes in a wider format (FLT_EVAL_METHOD): the run would not be the one that was judged"
#endif
{%- if word_bits == 32 %}
#if FLT_EVAL_METHOD == 1
#error "the compiler computes float as double (FLT_EVAL_METHOD): the run would not be the one that was judged"
#endif
{%- endif %}
/* GCC does not know the pragma. It contracts no products unless it is told to, by -std=gnu99 or -ffp-contract=fast, and the
 * self-test finds out whether it does. */
#if defined(__clang__) || !defined(__GNUC__)
#pragma STDC FP_CONTRACT OFF
#endif

typedef number wide;

#define DIGITS {{ words.digits }}u /* of the significand, the leading one included */
#define BIAS {{ words.bias }}
#define NUMBER_MAX {{ max }}
#define ONE {{ one }}
#define RESOLUTION {{ resolution }}

typedef union {
    number value;
    {{ words.unsigned }} bits;
} float_bits;

typedef char has_the_width[(sizeof(float_bits) == sizeof({{ words.unsigned }})) ? 1 : -1];

static number of_bits({{ words.unsigned }} bits)
{
    float_bits both;
    both.bits = bits;
    return both.value;
}

static {{ words.unsigned }} bits_of(number a)
{
    float_bits both;
    both.value = a;
    return both.bits;
}

static number add(number a, number b)
{
    return a + b;
}

static number sub(number a, number b)
{
    return a - b;
}

static number negative(number a)
{
    return -a;
}

static wide product(number a, number b)
{
    return a * b;
}

static wide plus(wide a, wide b)
{
    return a + b;
}

static number rounded(wide sum)
{
    return sum;
}

static number mul(number a, number b)
{
    return a * b;
}

/* a factor + b, rounded twice. */
static number mul_add(number a, number factor, number b)
{
    const number both = a * factor;
    return both + b;
}

static number divide(number a, number b)
{
    return a / b;
}

static number absolute(number a)
{
    return (a < {{ zero }}) ? -a : a;
}

static number minimum(number a, number b)
{
    return (b < a) ? b : a;
}

static number maximum(number a, number b)
{
    return (b > a) ? b : a;
}

/* a 2^exponent, for exponents of normal numbers. */
static number times_power_of_two(number a, int32_t exponent)
{
{%- if word_bits == 32 %}
    const int32_t within = (exponent < -126) ? -126 : ((exponent > 127) ? 127 : exponent);
    const int32_t biased = within + BIAS;
    return a * of_bits((uint32_t)biased << (DIGITS - 1u));
{%- else %}
    const int32_t biased = exponent + BIAS;
    return a * of_bits((uint64_t)biased << (DIGITS - 1u));
{%- endif %}
}

static number half(number a)
{
    return a * {{ one_half }};
}

/* sqrt(a) for a >= 0, to nearest, bit by bit. */
static number square_root(number a)
{
    if (!(a > {{ zero }}) || (a > NUMBER_MAX)) {
        return a;
    }
    int32_t exponent = 0;
    number normal = a;
    if (a < {{ words.least_normal }}) {
        normal = times_power_of_two(a, 2 * (int32_t)DIGITS);
        exponent = -2 * (int32_t)DIGITS;
    }
    const uint64_t bits = (uint64_t)bits_of(normal);
    const uint64_t leading_one = UINT64_C(1) << (DIGITS - 1u);
    const uint64_t biased = bits >> (DIGITS - 1u);
    exponent += (int32_t)biased - BIAS;
    uint64_t rest = (bits & (leading_one - 1u)) | leading_one;
    /* An even exponent, half of which is the root's. */
    if ((exponent % 2) != 0) {
        rest <<= 1;
        exponent--;
    }
    rest <<= 1;
    uint64_t root = 0u;  /* with one bit more than the format has */
    uint64_t twice = 0u; /* 2 root, in the present unit */
    for (uint64_t bit = UINT64_C(1) << DIGITS; bit != 0u; bit >>= 1) {
        if (rest >= (twice + bit)) {
            rest -= twice + bit;
            twice += 2u * bit;
            root += bit;
        }
        rest <<= 1;
    }
    /* With a rest the last bit tells to which side it rounds; it is no tie. */
    root = (root >> 1) + (((rest != 0u) && ((root & 1u) != 0u)) ? 1u : 0u);
    const int32_t place = (exponent / 2) + BIAS - 1;
    const uint64_t found = ((uint64_t)place << (DIGITS - 1u)) + root; /* the leading one adds itself to the exponent */
    return of_bits(({{ words.unsigned }})found);
}

/* The sum of the squares of a vector times 2^exponent. */
static number sum_of_squares(const number vector[AXES], int32_t exponent)
{
    number sum = {{ zero }};
    for (uint32_t d = 0u; d < AXES; d++) {
        const number v = times_power_of_two(vector[d], exponent);
        const number square = v * v;
        sum = sum + square;
    }
    return sum;
}

/* The length of a vector. Where squares would leave the format's range, its components are scaled first. */
static number norm(const number vector[AXES])
{
    const number sum = sum_of_squares(vector, 0);
    if (sum < ({{ words.least_normal }} / RESOLUTION)) {
        return times_power_of_two(square_root(sum_of_squares(vector, {{ words.half_range }})), -{{ words.half_range }});
    }
    if (sum > NUMBER_MAX) {
        return times_power_of_two(square_root(sum_of_squares(vector, -{{ words.half_range }})), {{ words.half_range }});
    }
    return square_root(sum);
}

/* phase / 2^64 in the leading bits of the phase, to nearest. */
static number fraction(uint64_t phase)
{
{%- if word_bits == 32 %}
    const uint64_t leading = phase >> 32;
    return (number)(uint32_t)leading * {{ words.fraction_unit }};
{%- else %}
    const uint64_t leading = phase >> 1;
    return (number)(int64_t)leading * {{ words.fraction_unit }};
{%- endif %}
}


/* Zeros before the first one of a; 63 for 0. */
static uint32_t leading_zeros(uint64_t a)
{
    uint32_t zeros = 0u;
    uint64_t rest = a;
    for (uint32_t step = 32u; step != 0u; step >>= 1) {
        const uint64_t upper = rest >> (64u - (uint64_t)step);
        if (upper == 0u) {
            rest <<= step;
            zeros += step;
        }
    }
    return zeros;
}

/* phase 2^(exponent - 64), cut toward 0. */
static number from_phase(uint64_t phase, int32_t exponent)
{
    const uint32_t zeros = leading_zeros(phase);
    const int32_t biased = exponent + BIAS - 1 - (int32_t)zeros;
    if ((phase == 0u) || (biased < 1) || (biased > (2 * BIAS))) {
        /* Zero, or no normal number. */
        const uint32_t surplus = 64u - DIGITS;
        const uint32_t dropped = (zeros < surplus) ? (surplus - zeros) : 0u;
        const uint64_t kept_bits = phase >> dropped;
        const number kept = (number)kept_bits;
        return times_power_of_two(times_power_of_two(kept, (int32_t)dropped - 64), exponent);
    }
    const uint64_t significand = (phase << zeros) >> (64u - DIGITS);
    const int32_t before = biased - 1;
    const uint64_t place = (uint64_t)before;
    const uint64_t bits = (place << (DIGITS - 1u)) + significand; /* the leading one adds itself to the exponent */
    return of_bits(({{ words.unsigned }})bits);
}

/* a 2^(64 + exponent) as an integer, cut; 0 for a negative number; saturates. */
static uint64_t to_phase(number a, int32_t exponent)
{
    const {{ words.unsigned }} bits = bits_of(a);
    /* How far the exponent lies below that of 1/2; the sign counts as its first bit. */
    const {{ words.unsigned }} biased = bits >> (DIGITS - 1u);
    const int32_t distance = BIAS - 1 - (int32_t)biased - exponent;
    if ((distance < 0) || (distance >= {{ words.farthest }})) {
        const number scaled = times_power_of_two(times_power_of_two(a, 64), exponent);
        if (!(scaled > {{ zero }})) {
            return 0u;
        }
        return (scaled >= {{ words.two_to_64 }}) ? UINT64_MAX : (uint64_t)scaled;
    }
    const uint64_t significand = ((uint64_t)bits << (64u - DIGITS)) | (UINT64_C(1) << 63);
    return significand >> (uint32_t)distance;
}
{%- if adds_places %}

/* The place a on [0, 1) as a phase: the digits of 1 + a behind the point. False if the rounded place is 1 or more. */
static bool place_to_phase(number a, uint64_t *phase)
{
    const number raised = ONE + a;
    if (raised >= {{ words.two }}) {
        return false;
    }
    *phase = (uint64_t)bits_of(raised) << (65u - DIGITS);
    return true;
}
{%- endif %}
