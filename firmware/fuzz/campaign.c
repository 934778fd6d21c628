/* How the receiver bears a bad line: `campaign TRIALS FRAMES` damages streams of frames one byte at a time, TRIALS for
 * each way, and then lets FRAMES frames arrive damaged beyond that; it prints one JSON object. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "frame.h"

#define IN_STREAM 8
#define ROOM (IN_STREAM * FRAME_LONGEST + 8)

static uint64_t state = 88172645463325252u;

static uint32_t draw(uint32_t below) { /* xorshift64* */
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (uint32_t)((state * 2685821657736338717u >> 32) * below >> 32);
}

/* A message with some zeros in it, as messages have. */
static size_t any_frame(uint8_t *out) {
    uint8_t data[128];
    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = draw(3) == 0 ? 0 : (uint8_t)draw(256);
    }
    return frame_put(out, layouts[draw(LAYOUTS)].id, data);
}

/* Whether this good frame is one of those that were sent. */
static int was_sent(const struct frame *frame, const uint8_t bodies[][FRAME_PLAIN], size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (bodies[i][0] == frame->layout->id && !memcmp(bodies[i] + 1, frame->body, frame->layout->size)) {
            return 1;
        }
    }
    return 0;
}

struct found {
    size_t good, false_ones;
};

static struct found hear(const uint8_t *line, size_t count, const uint8_t bodies[][FRAME_PLAIN], size_t sent) {
    struct receiver receiver = {.count = 0};
    struct frame frame;
    struct found found = {0, 0};
    for (size_t at = 0, taken; at < count; at += taken) {
        taken = count - at;
        if (frame_take(&receiver, line + at, &taken, &frame) == FRAME_GOOD) {
            int true_one = was_sent(&frame, bodies, sent);
            found.good += true_one;
            found.false_ones += !true_one;
        }
    }
    return found;
}

static void keep_plain(const uint8_t *line, size_t count, uint8_t *plain) {
    struct receiver receiver = {.count = 0};
    struct frame frame;
    for (size_t at = 0, taken; at < count; at += taken) {
        taken = count - at;
        if (frame_take(&receiver, line + at, &taken, &frame) == FRAME_GOOD) {
            plain[0] = frame.layout->id;
            memcpy(plain + 1, frame.body, frame.layout->size);
        }
    }
}

enum way { FLIPPED, LOST, INSERTED, WAYS };
static const char *const names[WAYS] = {"flipped", "lost", "inserted"};

static size_t damage(uint8_t *line, size_t count, enum way way) {
    size_t at = draw((uint32_t)count);
    if (way == FLIPPED) {
        line[at] ^= (uint8_t)(1 + draw(255));
        return count;
    }
    if (way == LOST) {
        memmove(line + at, line + at + 1, count - at - 1);
        return count - 1;
    }
    memmove(line + at + 1, line + at, count - at);
    line[at] = (uint8_t)draw(256);
    return count + 1;
}

static void one_byte(enum way way, size_t trials) {
    size_t most = 0, sum = 0, false_ones = 0;
    for (size_t trial = 0; trial < trials; trial++) {
        uint8_t line[ROOM], bodies[IN_STREAM][FRAME_PLAIN];
        size_t count = 0;
        for (size_t i = 0; i < IN_STREAM; i++) {
            size_t length = any_frame(line + count);
            keep_plain(line + count, length, bodies[i]);
            count += length;
        }
        count = damage(line, count, way);
        line[count++] = 0;
        struct found found = hear(line, count, (const uint8_t(*)[FRAME_PLAIN])bodies, IN_STREAM);
        size_t lost = IN_STREAM - found.good;
        most = lost > most ? lost : most;
        sum += lost;
        false_ones += found.false_ones;
    }
    printf("\"%s\": {\"trials\": %zu, \"most_lost\": %zu, \"mean_lost\": %.3f, \"false\": %zu}, ", names[way], trials,
           most, (double)sum / (double)trials, false_ones);
}

/* Frames with 2 to 12 bytes overwritten: what gets through though it was not sent. */
static size_t corrupt(size_t frames) {
    size_t false_ones = 0;
    for (size_t trial = 0; trial < frames; trial++) {
        uint8_t line[ROOM], body[1][FRAME_PLAIN];
        size_t count = any_frame(line);
        keep_plain(line, count, body[0]);
        for (uint32_t bad = 2 + draw(11); bad > 0; bad--) {
            line[draw((uint32_t)count - 1)] = (uint8_t)(1 + draw(255)); /* a zero would only cut it short */
        }
        false_ones += hear(line, count, (const uint8_t(*)[FRAME_PLAIN])body, 1).false_ones;
    }
    return false_ones;
}

int main(int count, char **words) {
    if (count != 3) {
        fprintf(stderr, "usage: campaign TRIALS FRAMES\n");
        return 2;
    }
    size_t trials = strtoul(words[1], NULL, 10), frames = strtoul(words[2], NULL, 10);
    printf("{");
    for (enum way way = FLIPPED; way < WAYS; way++) {
        one_byte(way, trials);
    }
    printf("\"corrupt\": {\"frames\": %zu, \"false\": %zu}}\n", frames, corrupt(frames));
    return 0;
}
