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
