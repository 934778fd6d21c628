/* An AS5147 magnetic encoder on SPI: what to ask it, and what its answers say, over turns and through faults.
 *
 * Bit 15 of an answer makes the number of ones even, bit 14 says that something was wrong, and 14 bits are the value:
 * of an angle, of ENCODER_TURN a turn. An encoder answers in the frame after a command; boards see to that. */
#ifndef ENCODER_H
#define ENCODER_H

#include <stdbool.h>
#include <stdint.h>

#include "messages.h"

#define ENCODER_TURN 16384
#define ENCODER_PATIENCE 5 /* bad answers in a row that are borne: meanwhile the angle is taken to go on as it did */

/* A bad answer adds to the doubt, a good angle takes away less, so that an encoder of which more than one answer in
 * three is bad is not believed for long, and one that is bad now and then is for ever. */
#define ENCODER_BAD 2
#define ENCODER_GOOD 1

enum encoder_command {
    ENCODER_NOTHING = 0,      /* nothing was asked yet */
    ENCODER_ANGLE = 0xFFFF,   /* read ANGLECOM, register 0x3FFF */
    ENCODER_ERRORS = 0x4001,  /* read ERRFL, which clears it */
    ENCODER_HEALTH = 0xFFFC,  /* read DIAAGC, register 0x3FFC: its bit 8 is set while it runs */
};

struct encoder {
    uint16_t asked;         /* enum encoder_command, whose answer comes next */
    int32_t turned;         /* the last good angle, over turns, of ENCODER_TURN */
    int32_t step;           /* how far it turned in a tick, of late */
    uint16_t raw;           /* the last good angle, within its turn */
    uint8_t bad;            /* bad answers in a row */
    uint8_t doubt;          /* see ENCODER_BAD */
    uint8_t zeros;          /* answers of nothing but zeros in a row */
    bool seen;              /* a good angle came since the start */
    bool paced;             /* two of them did, so that its step is known */
    uint8_t fault;          /* enum fault: why its answers are not believed any more */
};

/* Take the answer to what was asked, and say what to ask next. `fault` is set when there is no hope. */
uint16_t encoder_take(struct encoder *encoder, uint16_t answer);

/* Forget a fault; the angle is unknown until a good one comes. Also how it starts. */
void encoder_start(struct encoder *encoder);

/* The angle now, over turns, of ENCODER_TURN. */
int32_t encoder_angle(const struct encoder *encoder);

#endif
