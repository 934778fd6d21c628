#include "encoder.h"

#define SET_BY_FAULT 0x4000u
#define VALUE 0x3FFFu
#define QUICKEST 1320 /* of a turn in a tick: 12 % more than a free motor at 24 V */
#define MOST_CHANGE 200 /* of a turn in a tick, from one tick to the next */
#define FEW_ZEROS 3   /* a mallet may rest at angle 0: more of them in a row are looked into */

void encoder_start(struct encoder *encoder) {
    *encoder = (struct encoder){.asked = ENCODER_NOTHING};
}

static bool even(uint16_t word) {
    word ^= word >> 8;
    word ^= word >> 4;
    word ^= word >> 2;
    word ^= word >> 1;
    return (word & 1) == 0;
}

static void doubt(struct encoder *encoder, enum fault why) {
    if (encoder->doubt + ENCODER_BAD > ENCODER_PATIENCE * ENCODER_BAD) {
        encoder->fault = why;
    } else {
        encoder->bad++;
        encoder->doubt += ENCODER_BAD;
    }
}

static bool beyond(int32_t value, int32_t most) {
    return value > most || value < -most;
}

/* From one good angle to the next a motor turns no farther than it can, and nearly as it did before, if that is known: a
 * free one gains some 20 a tick at 24 V, one that hits something loses more. */
static bool possible(const struct encoder *encoder, int32_t step, int32_t ticks) {
    bool as_before = !encoder->paced || !beyond(step - encoder->step * ticks, MOST_CHANGE * ticks);
    return as_before && !beyond(step, QUICKEST * ticks);
}

static void take_angle(struct encoder *encoder, uint16_t angle) {
    if (encoder->seen) {
        int32_t ticks = encoder->bad + 1, step = (angle - encoder->raw) & VALUE;
        step -= step >= ENCODER_TURN / 2 ? ENCODER_TURN : 0;
        if (!possible(encoder, step, ticks)) {
            doubt(encoder, FAULT_ENCODER_JUMP);
            return;
        }
        encoder->turned += step;
        encoder->step = step / ticks;
        encoder->paced = true;
    } else {
        encoder->turned = angle;
        encoder->seen = true;
    }
    encoder->raw = angle;
    encoder->bad = 0;
    encoder->doubt -= encoder->doubt < ENCODER_GOOD ? encoder->doubt : ENCODER_GOOD;
}

static void understand(struct encoder *encoder, uint16_t answer) {
    if (answer == 0xFFFF) {
        doubt(encoder, FAULT_ENCODER_STUCK);
    } else if (!even(answer)) {
        doubt(encoder, FAULT_ENCODER_PARITY);
    } else if (encoder->asked == ENCODER_HEALTH && answer == 0) {
        encoder->fault = FAULT_ENCODER_STUCK; /* after so many zeros no doubt is left */
    } else if (answer & SET_BY_FAULT) {
        doubt(encoder, FAULT_ENCODER_ERROR);
    } else if (encoder->asked == ENCODER_ANGLE) {
        take_angle(encoder, answer & VALUE);
    }
}

static uint16_t next_command(const struct encoder *encoder, uint16_t answer) {
    if ((answer & SET_BY_FAULT) && answer != 0xFFFF && encoder->asked == ENCODER_ANGLE) {
        return ENCODER_ERRORS;
    }
    return encoder->zeros == FEW_ZEROS + 1 ? ENCODER_HEALTH : ENCODER_ANGLE;
}

uint16_t encoder_take(struct encoder *encoder, uint16_t answer) {
    if (encoder->asked != ENCODER_NOTHING) {
        encoder->zeros = answer == 0 ? encoder->zeros % (FEW_ZEROS + 1) + 1 : 0;
        understand(encoder, answer);
    }
    encoder->asked = next_command(encoder, answer);
    return encoder->asked;
}

int32_t encoder_angle(const struct encoder *encoder) {
    return encoder->turned + encoder->step * encoder->bad;
}
