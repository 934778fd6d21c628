#include "brake.h"

#include "curves.h"
#include "robot.h"

#define TICK (TICK_US * 1e-6f) /* s */
#define BRAKE_TICKS 75   /* at most: 3.3 m/s along both axes at once, by motors a fifth weaker than configured */
#define TRUST 0.6f       /* share of what the encoders say beside the model: a step of 7 um looks like 7 mm/s */
#define HASTE 0.35f       /* of what would stop an axis in one tick: no reversal, though it is stronger than configured */
#define REST 0.02f       /* m/s: slower than this an axis rests; it coasts on for 3 mm at most */
#define RESTING_TICKS 4  /* that it still brakes, once both axes came to rest */
#define OBEDIENCE 0.5f   /* least share of the configured deceleration: less, and a motor or an encoder is not as meant */
#define MARGIN 0.15f     /* m/s above the bound: what comes late, and the encoders' noise */
#define DEFIED_TICKS 4   /* a single wrong angle makes three wrong speeds */

void brake_start(struct brake *brake) {
    *brake = (struct brake){.going = true};
}

void brake_end(struct brake *brake) {
    brake->going = false;
}

bool brake_moves(const struct brake *brake) {
    return brake->going && brake->resting == 0;
}

/* Change of speed in a tick by a volt [m/s/V]: TICK R / (2 C6). */
static float push_of(const struct axis *axis) {
    return axis->rest_gain * axis->slow_rate * TICK;
}

/* The encoders tell the mean speed of the last tick, of which the last volts have done half, and of that, as the fast
 * mode takes 0.6 ms, again a half; so it is about the speed before they began. */
static void observe(struct brake *brake, const struct axis axes[2], const float speed[2]) {
    for (int i = 0; i < 2; i++) {
        if (brake->ticks == 0) {
            brake->coasting[i] = speed[i];
            brake->bound[i] = magnitude(speed[i]);
            continue;
        }
        float push = push_of(&axes[i]) * brake->volts[i];
        float model = brake->coasting[i] * (1.0f - axes[i].slow_rate * TICK) + push;
        brake->coasting[i] = model + TRUST * (speed[i] - (model - push));
        brake->bound[i] -= OBEDIENCE * magnitude(push);
        brake->bound[i] = brake->bound[i] > 0.0f ? brake->bound[i] : 0.0f;
    }
}

/* Whether both axes came to rest a while ago, one does not obey, or it took too long. */
static bool over(struct brake *brake, const float speed[2]) {
    bool defies = false;
    for (int i = 0; i < 2; i++) {
        brake->rested[i] = brake->rested[i] || magnitude(brake->coasting[i]) < REST;
        defies = defies || magnitude(speed[i]) > brake->bound[i] + MARGIN;
    }
    brake->resting += brake->rested[0] && brake->rested[1] ? 1 : 0;
    brake->defied = defies ? brake->defied + 1 : 0;
    return brake->resting > RESTING_TICKS || brake->defied == DEFIED_TICKS || brake->ticks == BRAKE_TICKS;
}

static float limited(float value, float most) {
    return value > most ? most : value < -most ? -most : value;
}

/* Cut the axes' volts to what two motors may give, together twice the most of one. Each axis keeps its half of it if it
 * needs that: so it stops no later than by a plan of as many volts, which stops it inside its area. */
static void share(float axes[2], float most) {
    float x = limited(axes[0], most), y = limited(axes[1], most);
    axes[0] = limited(axes[0], 2.0f * most - magnitude(y));
    axes[1] = limited(axes[1], 2.0f * most - magnitude(x));
}

void brake_volts(struct brake *brake, const struct axis axes[2], float most, const float speed[2], float motors[2]) {
    observe(brake, axes, speed);
    if (over(brake, speed)) {
        brake_end(brake);
        motors[0] = motors[1] = 0.0f;
        return;
    }
    brake->ticks++;
    for (int i = 0; i < 2; i++) {
        brake->volts[i] = -HASTE * brake->coasting[i] / push_of(&axes[i]);
    }
    share(brake->volts, most);
    motor_volts(brake->volts, most, motors);
}
