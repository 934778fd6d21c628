/* The two curves that a path needs, in single precision and without the double precision of a C library's. */
#ifndef EXPONENTIAL_H
#define EXPONENTIAL_H

/* exp(-x) for x >= 0, to 2e-7. */
float decay(float x);

/* log(1 + z) for z >= 0, to 2e-7 of it or of 1. */
float log_above(float z);

#endif
