/* Feed-forward and feedback: from where the path has the mallet, and where it is, to the voltages of the axes. */
#ifndef CONTROL_H
#define CONTROL_H

#include <stdbool.h>

#include "messages.h"

struct control {
    float integral[2]; /* V */
    float error[2];    /* m, in the tick before */
    float rate[2];     /* m/s of the error, smoothed */
    bool going;        /* there was a tick before */
};

/* Forget what was. */
void control_start(struct control *control);

/* One tick of TICK_US: voltages of motors 0 and 1, neither above config->most_volts. forward: the path's own
 * voltages of the axes; error: path less place, of each axis [m]. */
void control_volts(struct control *control, const struct config *config, const float forward[2], const float error[2],
                   float motors[2]);

/* Where the path had the mallet in the last ticks: what feedback is compared with, where motors obey late. */
#define SETPOINTS 12 /* ticks: the longest delay that may be configured, and one more */

struct setpoint {
    float place[2]; /* m */
    bool leaps;     /* a new path begins here, and may leap a little */
};

struct setpoints {
    struct setpoint kept[SETPOINTS];
    uint8_t newest, count;
};

/* Forget all: a mallet at rest begins to move. */
void setpoints_start(struct setpoints *setpoints);

/* That of a new tick. */
void setpoints_add(struct setpoints *setpoints, const float place[2], bool leaps);

/* The one so many us before the newest, on the line between two ticks; before the first, the first. */
struct setpoint setpoint_before(const struct setpoints *setpoints, uint16_t ago);

#endif
