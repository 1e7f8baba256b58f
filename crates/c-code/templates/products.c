/* Cortex-M0, M0+ and M23 multiply no further than to 32 bits: there, products are put together from halves of words. */
#if !defined(FEEDBITS_SHORT_PRODUCTS)
#if defined(__ARM_ARCH_6M__) || defined(__ARM_ARCH_8M_BASE__)
#define FEEDBITS_SHORT_PRODUCTS 1
#else
#define FEEDBITS_SHORT_PRODUCTS 0
#endif
#endif

/* What every period passes through stands in its midst where speed counts. Where size does, the compiler decides. */
#if defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define IN_PLACE static inline __attribute__((always_inline))
#else
#define IN_PLACE static inline
#endif

/* a b, exactly. */
IN_PLACE uint64_t long_product(uint32_t a, uint32_t b)
{
#if FEEDBITS_SHORT_PRODUCTS
    const uint32_t a_low = a & UINT16_MAX;
    const uint32_t a_high = a >> 16;
    const uint32_t b_low = b & UINT16_MAX;
    const uint32_t b_high = b >> 16;
    const uint32_t low = a_low * b_low;
    const uint32_t middle = (a_high * b_low) + (low >> 16);
    const uint32_t other = (a_low * b_high) + (middle & UINT16_MAX);
    const uint32_t high = (a_high * b_high) + (middle >> 16) + (other >> 16);
    return ((uint64_t)high << 32) | ((other << 16) | (low & UINT16_MAX));
#else
    return (uint64_t)a * b;
#endif
}

/* 128 bits. */
typedef struct {
    uint64_t high;
    uint64_t low;
} two_words;

/* a b, exactly, from four products of 32 bits. */
IN_PLACE two_words product_of_words(uint64_t a, uint64_t b)
{
    const uint32_t a_low = (uint32_t)a;
    const uint32_t a_high = (uint32_t)(a >> 32);
    const uint32_t b_low = (uint32_t)b;
    const uint32_t b_high = (uint32_t)(b >> 32);
    const uint64_t low = long_product(a_low, b_low);
    const uint64_t cross_one = long_product(a_high, b_low) + (low >> 32);
    const uint64_t cross_two = long_product(a_low, b_high) + (uint32_t)cross_one;
    two_words product;
    product.high = long_product(a_high, b_high) + (cross_one >> 32) + (cross_two >> 32);
    product.low = (cross_two << 32) | (uint32_t)low;
    return product;
}
