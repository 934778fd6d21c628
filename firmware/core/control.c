#include "control.h"

#include "gantry.h"
#include "robot.h"

#define TICK (TICK_US * 1e-6f) /* s */
#define SMOOTHING 0.25f        /* share of a new rate: an encoder's step of 14 um in a tick looks like 14 mm/s */

void control_start(struct control *control) {
    *control = (struct control){.going = false};
}

void control_volts(struct control *control, const struct config *config, const float forward[2], const float error[2],
                   float motors[2]) {
    float axes[2];
    for (int i = 0; i < 2; i++) {
        float rate = control->going ? (error[i] - control->error[i]) * (1.0f / TICK) : 0.0f;
        control->rate[i] += SMOOTHING * (rate - control->rate[i]);
        control->error[i] = error[i];
        axes[i] = forward[i] + config->proportional[i] * error[i] + config->derivative[i] * control->rate[i];
        axes[i] += control->integral[i];
    }
    control->going = true;
    if (motor_volts(axes, config->most_volts, motors)) {
        return; /* what is not given must not pile up: the integral waits while the motors give all they may */
    }
    for (int i = 0; i < 2; i++) {
        control->integral[i] += config->integral[i] * error[i] * TICK;
    }
}

void setpoints_start(struct setpoints *setpoints) {
    setpoints->count = 0;
}

void setpoints_add(struct setpoints *setpoints, const float place[2], bool leaps) {
    setpoints->newest = (uint8_t)((setpoints->newest + 1u) % SETPOINTS);
    setpoints->kept[setpoints->newest] = (struct setpoint){{place[0], place[1]}, leaps};
    setpoints->count += setpoints->count < SETPOINTS ? 1 : 0;
}

/* The one so many ticks before the newest, or the first. */
static const struct setpoint *kept_before(const struct setpoints *setpoints, uint32_t ticks) {
    uint32_t oldest = setpoints->count - 1u;
    uint32_t back = ticks < oldest ? ticks : oldest;
    return &setpoints->kept[(setpoints->newest + SETPOINTS - back) % SETPOINTS];
}

struct setpoint setpoint_before(const struct setpoints *setpoints, uint16_t ago) {
    uint32_t ticks = ago / TICK_US, rest = ago % TICK_US;
    const struct setpoint *later = kept_before(setpoints, ticks);
    if (rest == 0) {
        return *later;
    }
    const struct setpoint *sooner = kept_before(setpoints, ticks + 1);
    float share = (float)rest * (1.0f / TICK_US);
    struct setpoint between = {.leaps = later->leaps || sooner->leaps};
    for (int i = 0; i < 2; i++) {
        between.place[i] = later->place[i] + share * (sooner->place[i] - later->place[i]);
    }
    return between;
}
