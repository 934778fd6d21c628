#include "frame.h"

#include <string.h>

#include "crc32.h"
#include "wire.h"

static uint32_t crc_of(const uint8_t *plain, size_t count) {
    return crc32(plain[0] == MESSAGE_UNCHECKED ? 0 : PROTOCOL_SCHEMA, plain, count);
}

static const struct layout *layout_of(uint8_t id) {
    return id >= 1 && id <= LAYOUTS ? &layouts[id - 1] : NULL;
}

static bool open_frame(const uint8_t *kept, size_t length, struct frame *frame) {
    const struct layout *layout = length > FRAME_CRC ? layout_of(kept[0]) : NULL;
    if (layout == NULL || length != 1u + layout->size + FRAME_CRC) {
        return false;
    }
    memcpy(&frame->crc, kept + length - FRAME_CRC, FRAME_CRC);
    frame->layout = layout;
    frame->body = kept + 1;
    return frame->crc == crc_of(kept, length - FRAME_CRC);
}

enum frame_result frame_take(struct receiver *receiver, const uint8_t *bytes, size_t *count, struct frame *frame) {
    size_t given = *count, kept = receiver->count, left = receiver->left; /* in registers: this is done for every byte */
    for (size_t i = 0; i < given; i++) {
        uint8_t byte = bytes[i];
        if (byte == 0) {
            *count = i + 1;
            receiver->count = receiver->left = 0;
            if (kept == 0) {
                return FRAME_OPEN; /* zeros may stand between frames */
            }
            return left == 0 && open_frame(receiver->kept + 1, kept - 1, frame) ? FRAME_GOOD : FRAME_DAMAGED;
        }
        if (left == 0) { /* a code byte stands for a zero, and says where the next is; 0xFF is beyond any frame */
            left = byte;
            byte = 0;
        }
        left--;
        if (kept < sizeof receiver->kept) {
            receiver->kept[kept++] = byte;
        }
    }
    receiver->count = (uint8_t)kept;
    receiver->left = (uint8_t)left;
    return FRAME_OPEN;
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
