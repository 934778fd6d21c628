#include "curves.h"

#include <stdint.h>
#include <string.h>

static float of_bits(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* 1/k! for k from 7 down, of 2^30. */
static const int32_t factorials[] = {0x00034034, 0x0016C16C, 0x00888889, 0x02AAAAAB,
                                     0x0AAAAAAB, 0x20000000, 0x40000000, 0x40000000};

#define LOG2_E 0xB8AA3B29u    /* log2(e), of 2^31 */
#define LOG_2 0xB17217F8u     /* log(2), of 2^32 */
#define ROOT_HALF 0xB504F334u /* sqrt(1/2), of 2^32 */

/* exp(-z) of 2^30; z from -0.35 to 0.35, of 2^32. */
static int32_t decay_near(int32_t z) {
    int32_t sum = factorials[0];
    for (int k = 1; k < 8; k++) {
        sum = factorials[k] - (int32_t)((int64_t)z * sum >> 32);
    }
    return sum;
}

/* In whole numbers, which this processor multiplies in one instruction: soft floats take seven times as long. x log2(e)
 * has a whole part, which makes the exponent, and the rest, less a half, which goes through the series. */
float decay(float x) {
    if (!(x < 80.0f)) {
        return 0.0f;
    }
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    int32_t shift = 149 - (int32_t)(bits >> 23); /* of x's mantissa, for 32 bits behind the point */
    if (shift > 63) {
        return 1.0f;
    }
    uint64_t doublings = (uint64_t)((bits & 0x7FFFFFu) | 0x800000u) * LOG2_E >> shift;
    uint32_t whole = (uint32_t)(doublings >> 32);
    int32_t rest = (int32_t)((uint32_t)doublings - 0x80000000u);
    int32_t near = decay_near((int32_t)((int64_t)rest * LOG_2 >> 32));
    uint32_t scaled = (uint32_t)((uint64_t)(uint32_t)near * ROOT_HALF >> 32); /* from 2^29 to 2^30 */
    return of_bits(((125u - whole) << 23) + ((scaled + 32u) >> 6));
}

float log_above(float z) {
    float value = 1.0f + z;
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    int32_t doublings = (int32_t)(bits - 0x3F3504F3u) >> 23; /* so that the rest is from sqrt(1/2) to sqrt(2) */
    float rest = of_bits(bits - ((uint32_t)doublings << 23));
    float s = (rest - 1.0f) / (rest + 1.0f), square = s * s;
    float series = 1.0f / 9.0f;
    series = series * square + 1.0f / 7.0f;
    series = series * square + 1.0f / 5.0f;
    series = series * square + 1.0f / 3.0f;
    series = series * square + 1.0f;
    return (float)doublings * 0.693147181f + 2.0f * s * series;
}

float root(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    float guess = of_bits((bits >> 1) + 0x1FC00000u); /* half the exponent: at most 6 % off */
    for (int i = 0; i < 3; i++) {
        guess = 0.5f * (guess + x / guess);
    }
    return guess;
}
