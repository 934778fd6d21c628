/* libFuzzer's way into the parser: raw bytes, and bytes with the right CRC put behind them, so that it comes to the
 * fields. What a good frame gives must be what its message allows. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "crc32.h"
#include "frame.h"
#include "wire.h"

union body {
    struct hello hello;
    struct config config;
    struct traj traj;
    struct telemetry telemetry;
    uint8_t bytes[128];
};

static void require(int holds) {
    if (!holds) {
        abort();
    }
}

static void understand(const struct frame *frame) {
    union body body;
    uint8_t again[FRAME_LONGEST];
    memset(&body, 0, sizeof body);
    if (!wire_read(frame->layout, frame->body, &body)) {
        return;
    }
    if (frame->layout->id == MESSAGE_TRAJ) {
        require(isfinite(body.traj.volts[0]) && isfinite(body.traj.fast[1]) && body.traj.t2[1] <= 10000000u);
    }
    require(frame_put(again, frame->layout->id, &body) <= FRAME_LONGEST);
}

/* Put the bytes on the line as they are. */
static void hear(const uint8_t *bytes, size_t count) {
    struct receiver receiver = {.count = 0};
    struct frame frame;
    for (size_t at = 0, taken; at < count; at += taken) {
        taken = count - at;
        if (frame_take(&receiver, bytes + at, &taken, &frame) == FRAME_GOOD) {
            understand(&frame);
        }
        require(taken > 0 && receiver.count <= sizeof receiver.kept);
    }
}

/* Put them there as a frame whose CRC is right. */
static void hear_sealed(const uint8_t *bytes, size_t count) {
    uint8_t plain[260], line[270];
    size_t code = 0, at = 1;
    count = count < 240 ? count : 240;
    memcpy(plain, bytes, count);
    uint32_t crc = crc32(plain[0] == MESSAGE_UNCHECKED ? 0 : PROTOCOL_SCHEMA, plain, count);
    memcpy(plain + count, &crc, sizeof crc);
    for (size_t i = 0; i < count + sizeof crc; i++) {
        if (plain[i] == 0) {
            line[code] = (uint8_t)(at - code);
            code = at++;
        } else {
            line[at++] = plain[i];
        }
    }
    line[code] = (uint8_t)(at - code);
    line[at++] = 0;
    hear(line, at);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    hear(data, size);
    if (size > 0) {
        hear_sealed(data, size);
    }
    return 0;
}
