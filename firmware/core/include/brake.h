/* A stop that stops the mallet (IEC 60204-1, category 1): the motors brake it until it rests, and only then are off.
 * Left to itself it would coast on for up to half a metre. */
#ifndef BRAKE_H
#define BRAKE_H

#include <stdbool.h>
#include <stdint.h>

#include "gantry.h"
#include "messages.h"

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

/* What outlives a reset: how to brake a mallet that was driven then, and would coast on for up to half a metre. It lies
 * in memory that the start-up code does not clear. It holds something as long as a motor may be driven, is good for one
 * start, and believed by its CRC. */
struct kept {
    struct config config;
    uint32_t crc;
};

/* From now on a motor may be driven, by this configuration. */
void kept_hold(struct kept *kept, const struct config *config);

/* No more. */
void kept_drop(struct kept *kept);

/* Take what was held when the board was reset, and drop it; false, if nothing was. */
bool kept_take(struct kept *kept, struct config *config);

#endif
