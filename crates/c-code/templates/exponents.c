{% if exponents.use_function("raised") -%}
/* The same where the exponent is not negative. */
static number raised(number a, int32_t exponent)
{
    return of_bits((word)((word)a << (uint32_t)exponent));
}

{% endif -%}
{% if exponents.use_function("lowered") -%}
/* The same where it is negative. */
static number lowered(number a, int32_t exponent)
{
    const int32_t distance = -exponent;
    const number twice = shifted_right(a, (uint32_t)distance - 1u);
    return add(shifted_right(twice, 1u), of_bits((word)twice & 1u));
}

{% endif -%}
{% if exponents.use_function("lowered_or_kept") -%}
/* The same where it is not positive. */
static number lowered_or_kept(number a, int32_t exponent)
{
    const uint32_t distance = (uint32_t)-exponent;
    const word twice = (word)((word)a << 1);
    return add(shifted_right(a, distance), of_bits((word)(twice >> distance) & 1u));
}

{% endif -%}
static number half(number a)
{
    return add(shifted_right(a, 1u), of_bits((word)a & 1u));
}