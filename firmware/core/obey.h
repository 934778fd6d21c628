/* What the host asks for: done, or refused with the reason. */
#ifndef OBEY_H
#define OBEY_H

#include "robot_state.h"

/* Do what a message asks. received: when its last byte came [us]. */
void obey(struct robot *robot, const struct frame *frame, uint32_t received);

/* Look at one axis of a trajectory that came in an earlier tick, if that is still to be done. */
void vet(struct robot *robot);

#endif
