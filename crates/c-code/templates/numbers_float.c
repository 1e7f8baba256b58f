/* Numbers: {{ format }}, with every operation rounded on its own, as IEEE 754 says. */
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

/* The same for a factor of order one. */
static number mul_by(number a, number factor)
{
    return a * factor;
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

/* |a| <= limit, by the bits: those of positive floats are in the order of the floats. */
static bool is_at_most(number a, number limit)
{
    return (bits_of(a) << 1) <= (bits_of(limit) << 1);
}

/* Whether a is from 0 to 1, by the bits, as above: -0 and NaN are greater. */
static bool is_part(number a)
{
    return bits_of(a) <= bits_of(ONE);
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
    const {{ words.unsigned }} bits = bits_of(normal);
    const {{ words.unsigned }} leading_one = ({{ words.unsigned }})1 << (DIGITS - 1u);
    const {{ words.unsigned }} biased = bits >> (DIGITS - 1u);
    exponent += (int32_t)biased - BIAS;
    {{ words.unsigned }} rest = (bits & (leading_one - 1u)) | leading_one;
    /* An even exponent, half of which is the root's. */
    if ((exponent % 2) != 0) {
        rest <<= 1;
        exponent--;
    }
    rest <<= 1;
    {{ words.unsigned }} twice = 0u; /* 2 root, with one bit more than the format has */
    for ({{ words.unsigned }} bit = ({{ words.unsigned }})1 << DIGITS; bit != 0u; bit >>= 1) {
        if (rest >= (twice + bit)) {
            rest -= twice + bit;
            twice += 2u * bit;
        }
        rest <<= 1;
    }
    /* With a rest the last bit tells to which side it rounds; it is no tie. */
    const {{ words.unsigned }} root = (twice >> 2) + (((rest != 0u) && ((twice & 2u) != 0u)) ? 1u : 0u);
    const int32_t place = (exponent / 2) + BIAS - 1;
    /* The leading one adds itself to the exponent. */
    return of_bits((({{ words.unsigned }})place << (DIGITS - 1u)) + root);
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

/* Zeros before the first one of a, which is not 0: from the exponent of a float. */
static uint32_t leading_zeros(uint32_t a)
{
    /* Without the bit behind the first one, it is not rounded up to the next power of two. */
    const uint32_t sparse = a & ~(a >> 1);
    const {{ words.unsigned }} place = bits_of((number)sparse) >> (DIGITS - 1u);
    return (uint32_t)BIAS + 31u - (uint32_t)place;
}

/* phase 2^(exponent - 64), cut toward 0. */
static number from_phase(uint64_t phase, int32_t exponent)
{
    const uint32_t high = (uint32_t)(phase >> 32);
    const uint32_t low = (uint32_t)phase;
    const uint32_t first = (high != 0u) ? high : low;
    if (first == 0u) {
        return {{ zero }};
    }
    const uint32_t zeros = leading_zeros(first);
    const int32_t biased = exponent + BIAS - ((high != 0u) ? 1 : 33) - (int32_t)zeros;
    if ((biased < 1) || (biased > (2 * BIAS))) {
        /* No normal number. */
        const uint32_t all_zeros = zeros + ((high != 0u) ? 0u : 32u);
        const uint32_t surplus = 64u - DIGITS;
        const uint32_t dropped = (all_zeros < surplus) ? (surplus - all_zeros) : 0u;
        const uint64_t kept_bits = phase >> dropped;
        const number kept = (number)kept_bits;
        return times_power_of_two(times_power_of_two(kept, (int32_t)dropped - 64), exponent);
    }
    const uint32_t second = (high != 0u) ? low : 0u;
{%- if word_bits == 32 %}
    const uint32_t leading = (first << zeros) | ((second >> 1) >> (31u - zeros));
    const uint32_t significand = leading >> (32u - DIGITS);
{%- else %}
    const uint64_t leading = (((uint64_t)first << 32) | second) << zeros;
    const uint64_t significand = leading >> (64u - DIGITS);
{%- endif %}
    const int32_t before = biased - 1;
    const {{ words.unsigned }} place = ({{ words.unsigned }})before;
    return of_bits((place << (DIGITS - 1u)) + significand); /* the leading one adds itself to the exponent */
}

/* units / 2^32, cut, for less than one. */
static number fraction_of_period(uint64_t units)
{
    return from_phase(units, 32);
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
