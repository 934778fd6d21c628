/* See robot.c. */
#ifndef ROBOT_STATE_H
#define ROBOT_STATE_H

#include <stdint.h>

struct robot {
    uint32_t cause, boots, steps, missed, lost, longest, heard;
    uint16_t command;
    int16_t pwm[2];
};

#endif
