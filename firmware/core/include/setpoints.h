/* Where the path had the mallet in the last ticks: what feedback is compared with, where motors obey late. */
#ifndef SETPOINTS_H
#define SETPOINTS_H

#include <stdbool.h>
#include <stdint.h>

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
