/* What the robot may do: states, the faults that stop it, and the news of both. */
#ifndef SAFETY_H
#define SAFETY_H

#include "robot_state.h"

/* Tell the host. */
void tell(struct robot *robot, enum notice notice, uint32_t detail);

/* Change state; whatever is played ends where the new state does not play. */
void enter(struct robot *robot, enum state state);

/* Stop the motors and stay stopped; the first reason is kept. */
void raise_fault(struct robot *robot, enum fault why);

/* Leave FAULT, for IDLE if it is still known where the mallet is. */
void recover(struct robot *robot);

/* Look for reasons to stop, once a tick, after the encoders were read. missed: ticks that were not served. */
void watch(struct robot *robot, uint16_t missed);

#endif
