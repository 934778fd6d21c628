/* What the host asks for: done, or refused with the reason. */
#ifndef OBEY_H
#define OBEY_H

#include "robot_state.h"

/* Do what a message asks. received: when its last byte came [us]. */
void obey(struct robot *robot, const struct frame *frame, uint32_t received);

/* Go on looking at the newest trajectory, a part in each call: all at once would take too long. After the ninth it may
 * begin. */
void vet(struct robot *robot);

#endif
