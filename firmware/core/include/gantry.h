/* The gantry's numbers: modes of an axis (report E.1, E.2) and CoreXY kinematics.
 *
 * An axis obeys C5 p''' + C6 p'' + C7 p' = (R/2) V, so that its place is rest + slow + fast: where it would coast to,
 * and two modes that fade at their own rates. Under a constant voltage u,
 *     rest' = rest_gain u,  slow' = -slow_rate (slow + slow_gain u),  fast' = -fast_rate (fast - fast_gain u). */
#ifndef GANTRY_H
#define GANTRY_H

#include <stdbool.h>

#include "messages.h"

struct axis {
    float slow_rate, fast_rate; /* 1/s */
    float rest_gain;            /* m/s/V */
    float slow_gain, fast_gain; /* m/V */
};

/* An axis from its coefficients [V s^3, V s^2, V s] and the pulley's radius [m]; false unless it is overdamped. */
bool axis_make(struct axis *axis, float c5, float c6, float c7, float radius);

/* Both axes of a configuration; false unless they are overdamped. */
bool axes_make(struct axis axes[2], const struct config *config);

/* Place [m] of a mallet, x and y, whose pulleys of this radius stand at these angles [rad] (report 37, 38). */
void mallet_place(const float angle[2], float radius, float place[2]);

/* Angles [rad] of the pulleys where the mallet is at this place: the inverse. */
void pulley_angles(const float place[2], float radius, float angle[2]);

/* Voltages of motors 0 and 1 for those of the axes x and y (report 2.3.1). If one were above most, both are scaled
 * down, so that the direction stays; true, if so. */
bool motor_volts(const float axes[2], float most, float motors[2]);

#endif
