/* A stop that stops the mallet (IEC 60204-1, category 1): the motors brake it until it rests, and only then are off.
 * Left to itself it would coast on for up to half a metre. */
#ifndef BRAKE_H
#define BRAKE_H

#include <stdbool.h>
#include <stdint.h>

#include "gantry.h"

struct brake {
    bool going;
    uint8_t ticks;     /* since it began */
    bool rested[2];    /* whether an axis came to rest */
    uint8_t resting;   /* ticks since both did */
    uint8_t defied;    /* ticks in a row that an axis was faster than its bound */
    float coasting[2]; /* m/s: speed of the axes, once what their volts still do is done */
    float volts[2];    /* V of the axes, in the tick before */
    float bound[2];    /* m/s: faster than this and a margin, an axis does not obey */
};

/* Begin to brake: the next brake_volts is the first. */
void brake_start(struct brake *brake);

/* The motors off at once. */
void brake_end(struct brake *brake);

/* Whether the mallet is braked and did not yet come to rest; then a motor has volts, from the first tick on. */
bool brake_moves(const struct brake *brake);

/* One tick of TICK_US: voltages of motors 0 and 1, neither above most [V], 0 once it is over. Ends by itself when both
 * axes rest, when one does not slow down as it should, or after BRAKE_TICKS. speed: of the axes in the last tick, by
 * the encoders [m/s]. */
void brake_volts(struct brake *brake, const struct axis axes[2], float most, const float speed[2], float motors[2]);

#endif
