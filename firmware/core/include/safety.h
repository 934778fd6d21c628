/* What the robot may do: states, the faults that stop it, and the news of both. */
#ifndef SAFETY_H
#define SAFETY_H

#include "robot_state.h"

/* Tell the host. */
void tell(struct robot *robot, enum notice notice, uint32_t detail);

/* Change state; whatever is played ends where the new state does not play. */
void enter(struct robot *robot, enum state state);

/* Stop the mallet and stay stopped; the first reason is kept. It is braked where that can be relied on (brake.h), else
 * the motors are off at once. */
void raise_fault(struct robot *robot, enum fault why);

/* From ARMED to IDLE; the mallet is braked. */
void stand_down(struct robot *robot);

/* Leave FAULT, for IDLE if it is still known where the mallet is. */
void recover(struct robot *robot);

/* Look for reasons to stop, once a tick, after the encoders were read. missed: ticks that were not served. */
void watch(struct robot *robot, uint16_t missed);

#endif
