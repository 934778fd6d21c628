/* The curves that the core needs, in single precision and without a C library. */
#ifndef CURVES_H
#define CURVES_H

static inline float magnitude(float x) {
    return x < 0.0f ? -x : x;
}

/* exp(-x) for x >= 0, to 1e-7 of it; 0 from 80 on. */
float decay(float x);

/* log(1 + z) for z >= 0, to 3e-7 of it or 1.3e-7. */
float log_above(float z);

/* Square root of x > 0, to 2e-7 of it. */
float root(float x);

#endif
