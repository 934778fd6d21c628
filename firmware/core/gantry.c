#include "gantry.h"

#include "curves.h"

bool axis_make(struct axis *axis, float c5, float c6, float c7, float radius) {
    float discriminant = c6 * c6 - 4.0f * c5 * c7;
    if (!(discriminant > 0.0f)) {
        return false;
    }
    float fast_rate = (c6 + root(discriminant)) / (2.0f * c5);
    float slow_rate = c7 / (c5 * fast_rate);
    float spread = c5 * (fast_rate - slow_rate), half = 0.5f * radius;
    axis->slow_rate = slow_rate;
    axis->fast_rate = fast_rate;
    axis->rest_gain = half / c7;
    axis->slow_gain = half / (spread * slow_rate * slow_rate);
    axis->fast_gain = half / (spread * fast_rate * fast_rate);
    return true;
}

bool axes_make(struct axis axes[2], const struct config *config) {
    bool made = true;
    for (int i = 0; i < 2; i++) {
        made = made && axis_make(&axes[i], config->c5[i], config->c6[i], config->c7[i], config->pulley_radius);
    }
    return made;
}

void mallet_place(const float angle[2], float radius, float place[2]) {
    float half = 0.5f * radius;
    place[0] = (angle[0] - angle[1]) * half;
    place[1] = (-angle[0] - angle[1]) * half;
}

void pulley_angles(const float place[2], float radius, float angle[2]) {
    angle[0] = (place[0] - place[1]) / radius;
    angle[1] = (-place[0] - place[1]) / radius;
}

bool motor_volts(const float axes[2], float most, float motors[2]) {
    motors[0] = 0.5f * (axes[0] - axes[1]);
    motors[1] = 0.5f * (-axes[0] - axes[1]);
    float greater = magnitude(motors[magnitude(motors[1]) > magnitude(motors[0])]);
    if (!(greater > most)) {
        return false;
    }
    float share = most / greater;
    motors[0] *= share;
    motors[1] *= share;
    return true;
}
