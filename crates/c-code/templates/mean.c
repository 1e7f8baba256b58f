{%- match shape.name -%}
{%- when "CUBIC" %}    /* m^2 (3 - 2m) + w^2/4 (1 - 2m){% if !floating %}, rounded once{% endif %} */
    const number rest = sub(ONE, middle);
    const number square = mul_by(middle, middle);
    const number bend = sub(rest, middle);
{%- if floating %}
    const number twice = mul_by(square, rest);
    return add(add(add(square, twice), twice), times_power_of_two(mul_by(mul_by(width, width), bend), -2));
{%- else %}
    const wide once = product(square, rest);
    const wide sum = plus(plus(once, once), product(times_power_of_two(mul_by(width, width), -2), bend));
    return add(square, rounded(sum)); /* the square has no digits behind the last place */
{%- endif %}
{%- when "ONSET" %}    /* m^2 + w^2/12 */
    return add(mul_by(middle, middle), mul_by(times_power_of_two(mul_by(width, width), -2), ONE_THIRD));
{%- when "STEADY" %}    return middle;
{%- when "EASING" %}    /* m + m (1 - m) - w^2/12 */
    const number bow = mul_by(times_power_of_two(mul_by(width, width), -2), ONE_THIRD);
    return sub(add(middle, mul_by(middle, sub(ONE, middle))), bow);
{%- when "BENT" %}    /* m + b (m (1 - m) - w^2/12) */
    const number bow = mul_by(times_power_of_two(mul_by(width, width), -2), ONE_THIRD);
    return mul_add(stage->bend, sub(mul_by(middle, sub(ONE, middle)), bow), middle);
{%- else %}    /* S^2 + (C^2 - S^2) (1 - sinc(pi w/2))/2 */
    number sine = {{ zero }};
    number cosine = {{ zero }};
    sin_cos_quarter(middle, &sine, &cosine);
    const number square = mul_by(sine, sine);
    return mul_add(sub(mul_by(cosine, cosine), square), half(sinc_lacks(width)), square);
{%- endmatch -%}
