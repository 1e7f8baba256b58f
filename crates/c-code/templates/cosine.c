#define HALF_PI {{ half_pi }}
#define SINE_TERMS {{ cosine_series.len() }}u
#define SINC_TERMS {{ sinc_series.len() }}u

/* 1/(2k (2k - 1)) and 1/(2k (2k + 1)) for k from 1 on. */
static const number cosine_series[SINE_TERMS] = { {{ cosine_series.join(", ") }} };
static const number sine_series[SINE_TERMS] = { {{ sine_series.join(", ") }} };

/* 4/(2k (2k + 1)) for k from 1 on. */
static const number sinc_series[SINC_TERMS] = { {{ sinc_series.join(", ") }} };

/* Sine and cosine of u quarter turns, |u| <= 1/2: the Taylor series, nested. */
static void small_angle(number u, number *sine, number *cosine)
{
    const number angle = mul_by(HALF_PI, u);
    const number square = mul_by(angle, angle);
    number sine_lacks = {{ zero }};
    number cosine_lacks = {{ zero }};
    for (uint32_t k = SINE_TERMS; k > 0u; k--) {
        cosine_lacks = mul_by(square, mul_by(sub(ONE, cosine_lacks), cosine_series[k - 1u]));
        sine_lacks = mul_by(square, mul_by(sub(ONE, sine_lacks), sine_series[k - 1u]));
    }
    *sine = mul_add(negative(angle), sine_lacks, angle);
    *cosine = sub(ONE, cosine_lacks);
}

/* (sin(pi u/2), cos(pi u/2)): the upper half mirrors the lower. */
static void sin_cos_quarter(number u, number *sine, number *cosine)
{
    if (u > ONE_HALF) {
        small_angle(maximum(sub(ONE, u), negative(ONE_HALF)), cosine, sine);
    } else {
        small_angle(maximum(u, negative(ONE_HALF)), sine, cosine);
    }
}

/* 1 - sinc(pi w/2) for w from 0 to 1: with q = (pi w/4)^2, 4q/6 (1 - 4q/20 (1 - 4q/42 ...)). */
static number sinc_lacks(number width)
{
    const number quarter = mul_by(half(HALF_PI), width);
    const number square = mul_by(quarter, quarter);
    number lacks = {{ zero }};
    for (uint32_t k = SINC_TERMS; k > 0u; k--) {
        lacks = mul_by(square, mul_by(sub(ONE, lacks), sinc_series[k - 1u]));
    }
    return lacks;
}
