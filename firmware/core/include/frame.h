/* Messages on the line: COBS of (id, body, CRC-32), then a zero byte, which stands nowhere else; so whatever was lost
 * or damaged, the next zero is the end of a frame. */
#ifndef FRAME_H
#define FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "messages.h"

#define FRAME_CRC 4
#define FRAME_PLAIN (1 + MESSAGE_LONGEST + FRAME_CRC) /* id, body, CRC */
#define FRAME_LONGEST (FRAME_PLAIN + 2)               /* one code byte, as it is under 254 bytes, and the zero */

/* A host's bytes on their way to messages: of the frame that is not yet whole, without COBS, a zero before it, and
 * one byte more than any has, by whose length it is none. */
struct receiver {
    uint8_t kept[1 + FRAME_PLAIN + 1];
    uint8_t count;
    uint8_t left; /* bytes up to the next code byte */
};

struct frame {
    const struct layout *layout;
    const uint8_t *body;
    uint32_t crc;
};

enum frame_result {
    FRAME_OPEN,    /* it goes on */
    FRAME_GOOD,    /* a message is there */
    FRAME_DAMAGED, /* it ended, and is none */
};

/* Take bytes up to the next zero, or all of them: `count` becomes how many were taken. The frame that FRAME_GOOD gives
 * lies in the receiver until more is taken. */
enum frame_result frame_take(struct receiver *receiver, const uint8_t *bytes, size_t *count, struct frame *frame);

/* Write a message to out, of FRAME_LONGEST bytes; data: its structure, NULL where it has no fields. How many bytes. */
size_t frame_put(uint8_t *out, enum message id, const void *data);

#endif
