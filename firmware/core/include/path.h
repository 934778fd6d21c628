/* The way of an axis that a trajectory asks for, in closed form (report E.2). */
#ifndef PATH_H
#define PATH_H

#include <stdbool.h>
#include <stdint.h>

#include "gantry.h"
#include "messages.h"

/* While one voltage holds, t seconds after it began, the modes are
 *     rest + drift t,  slow_end + slow_left exp(-slow_rate t),  fast_end + fast_left exp(-fast_rate t) [m]. */
struct leg {
    uint32_t begin; /* us since the path began */
    float volts;
    float rest, drift;
    float slow_end, slow_left;
    float fast_end, fast_left;
};

#define LEGS 3 /* volts, reversed, none */

struct path {
    struct leg legs[LEGS];
};

/* The path of axis number which (0 x, 1 y) of a trajectory, in two parts: legs 0 and 1, then leg 2. */
void path_begin(struct path *path, const struct axis *axis, const struct traj *traj, int which);
void path_end(struct path *path, const struct axis *axis, const struct traj *traj, int which);

/* Place [m] at a time [us] since the path began. */
float path_place(const struct path *path, const struct axis *axis, uint32_t time);

/* Mean voltage from a time [us] on for duration [us]. */
float path_volts(const struct path *path, uint32_t time, uint32_t duration);

/* Whether it stays inside [low, high] [m] from the beginning of leg number which to its end, for the last: to infinity. */
bool leg_inside(const struct path *path, int which, const struct axis *axis, float low, float high);

#endif
