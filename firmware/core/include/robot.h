/* The whole program between a board's inputs and its outputs, without a register: a board calls robot_step a thousand
 * times a second with what came in, and does what it says. Nothing runs beside it, so nothing can be half done. */
#ifndef ROBOT_H
#define ROBOT_H

#include <stdint.h>

#define TICK_US 1000
#define PWM_FULL 3600    /* duty of full voltage: 72 MHz at 20 kHz */
#define ROBOT_SEND 192   /* most bytes that one step sends */
#define ROBOT_ZEROS 8    /* most stamps of zero bytes that one step takes */

struct robot_input {
    uint32_t now;           /* us, wraps */
    uint16_t missed;        /* ticks that were due since the last step and not served */
    uint16_t lost;          /* bytes that came and could not be kept since the last step: overrun, framing, full */
    uint16_t answers[2];    /* what the two encoders sent back for the commands of the last step */
    const uint8_t *bytes;   /* what the host sent since the last step */
    uint16_t count;         /* how many */
    const uint32_t *zeros;  /* when each zero byte of them came [us], in order, the first ROBOT_ZEROS of them */
    uint16_t took;          /* us that the last step took */
};

struct robot_output {
    int16_t pwm[2];         /* signed duty of motors 0 and 1, -PWM_FULL to PWM_FULL */
    uint16_t commands[2];   /* to be sent to the encoders before the next step */
    uint16_t count;         /* bytes to send to the host */
    uint8_t bytes[ROBOT_SEND];
};

struct robot;
struct kept;

/* Begin: motors off, mallet unknown; but where one was driven when the board was reset, it is braked as soon as its speed
 * is known. cause: what reset the board, in its own numbers; boots: a number of this start; kept: what the board held
 * through the reset, nothing or random memory after a power-on. */
void robot_start(struct robot *robot, uint32_t cause, uint32_t boots, struct kept *kept);

/* One tick. */
void robot_step(struct robot *robot, const struct robot_input *in, struct robot_output *out);

#endif
