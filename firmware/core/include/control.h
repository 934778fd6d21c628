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

#endif
