#include "frame.h"

#include <string.h>

#include "crc32.h"
#include "wire.h"

static uint32_t crc_of(const uint8_t *plain, size_t count) {
    return crc32(plain[0] == MESSAGE_UNCHECKED ? 0 : PROTOCOL_SCHEMA, plain, count);
}

/* Take COBS off count bytes, in place. The number of bytes, 0 if they are no COBS. */
static size_t unstuff(uint8_t *bytes, size_t count) {
    size_t in = 0, out = 0;
    while (in < count) {
        size_t code = bytes[in++]; /* never 0: a zero ends the frame */
        if (code - 1 > count - in) {
            return 0;
        }
        for (size_t i = 1; i < code; i++) {
            bytes[out++] = bytes[in++];
        }
        if (code < 0xFF && in < count) {
            bytes[out++] = 0;
        }
    }
    return out;
}

static const struct layout *layout_of(uint8_t id) {
    for (size_t i = 0; i < LAYOUTS; i++) {
        if (layouts[i].id == id) {
            return &layouts[i];
        }
    }
    return NULL;
}

static bool open_frame(uint8_t *kept, size_t count, struct frame *frame) {
    size_t length = unstuff(kept, count);
    const struct layout *layout = length > FRAME_CRC ? layout_of(kept[0]) : NULL;
    if (layout == NULL || length != 1u + layout->size + FRAME_CRC) {
        return false;
    }
    uint32_t crc;
    memcpy(&crc, kept + length - FRAME_CRC, FRAME_CRC);
    frame->layout = layout;
    frame->body = kept + 1;
    return crc == crc_of(kept, length - FRAME_CRC);
}

static enum frame_result end_frame(struct receiver *receiver, struct frame *frame) {
    size_t count = receiver->count;
    bool overlong = receiver->overlong;
    receiver->count = 0;
    receiver->overlong = false;
    if (count == 0 && !overlong) {
        return FRAME_OPEN; /* zeros may stand between frames */
    }
    return !overlong && open_frame(receiver->kept, count, frame) ? FRAME_GOOD : FRAME_DAMAGED;
}

enum frame_result frame_take(struct receiver *receiver, const uint8_t *bytes, size_t *count, struct frame *frame) {
    size_t given = *count, length = 0, room = sizeof receiver->kept - receiver->count;
    uint8_t *to = receiver->kept + receiver->count;
    while (length < given && bytes[length] != 0) {
        if (length < room) {
            to[length] = bytes[length];
        }
        length++;
    }
    receiver->overlong = receiver->overlong || length > room;
    receiver->count = (uint8_t)(receiver->count + (length < room ? length : room));
    if (length == given) {
        return FRAME_OPEN;
    }
    *count = length + 1;
    return end_frame(receiver, frame);
}

size_t frame_put(uint8_t *out, enum message id, const void *data) {
    uint8_t plain[FRAME_PLAIN];
    const struct layout *layout = layout_of(id);
    size_t length = 1;
    plain[0] = id;
    wire_write(layout, data, plain + length);
    length += layout->size;
    uint32_t crc = crc_of(plain, length);
    memcpy(plain + length, &crc, FRAME_CRC);
    length += FRAME_CRC;

    size_t code = 0, at = 1; /* where the last code byte goes, and the next other */
    for (size_t i = 0; i < length; i++) {
        if (plain[i] == 0) {
            out[code] = at - code;
            code = at++;
        } else {
            out[at++] = plain[i];
        }
    }
    out[code] = at - code;
    out[at++] = 0;
    return at;
}
