/* The two curves that a path needs, in single precision and without the double precision of a C library's. */
#ifndef EXPONENTIAL_H
#define EXPONENTIAL_H

/* exp(-x) for x >= 0, to 4e-7 + 1.2e-7 x of it; 0 from 80 on. */
float decay(float x);

/* log(1 + z) for z >= 0, to 3e-7 of it or 1.3e-7. */
float log_above(float z);

#endif
