#include "curves.h"

#include <stdint.h>
#include <string.h>

static float of_bits(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

float decay(float x) {
    if (!(x < 80.0f)) {
        return 0.0f;
    }
    int32_t halvings = (int32_t)(x * 1.44269504f + 0.5f);
    float rest = ((float)halvings * 0.693145752f - x) + (float)halvings * 1.42860677e-6f; /* log 2 in two parts */
    float power = 1.0f / 720.0f;
    power = power * rest + 1.0f / 120.0f;
    power = power * rest + 1.0f / 24.0f;
    power = power * rest + 1.0f / 6.0f;
    power = power * rest + 0.5f;
    power = power * rest + 1.0f;
    power = power * rest + 1.0f;
    return power * of_bits((uint32_t)(127 - halvings) << 23);
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
