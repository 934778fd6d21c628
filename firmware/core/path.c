#include "path.h"

#include "curves.h"

#define SECONDS 1e-6f /* of a microsecond */
#define ROUNDING 1e-4f /* m: more than single precision and the fast mode are off by, less than matters */

/* The modes of a leg so many seconds after its beginning. */
static void modes_at(const struct leg *leg, const struct axis *axis, float since, struct leg *now) {
    float slow_end = -axis->slow_gain * leg->volts, fast_end = axis->fast_gain * leg->volts;
    now->rest = leg->rest + axis->rest_gain * leg->volts * since;
    now->slow = slow_end + (leg->slow - slow_end) * decay(axis->slow_rate * since);
    now->fast = fast_end + (leg->fast - fast_end) * decay(axis->fast_rate * since);
}

static float place_of(const struct leg *now) {
    return now->rest + (now->slow + now->fast);
}

void path_make(struct path *path, const struct axis *axis, const struct traj *traj, int which) {
    struct leg *legs = path->legs;
    float volts = traj->volts[which];
    legs[0] = (struct leg){0, volts, traj->rest[which], traj->slow[which], traj->fast[which]};
    legs[1] = (struct leg){.begin = traj->t1[which], .volts = -volts};
    legs[2] = (struct leg){.begin = traj->t2[which], .volts = 0.0f};
    for (int i = 1; i < LEGS; i++) {
        modes_at(&legs[i - 1], axis, (float)(legs[i].begin - legs[i - 1].begin) * SECONDS, &legs[i]);
    }
}

static const struct leg *leg_at(const struct path *path, uint32_t time) {
    const struct leg *leg = path->legs;
    while (leg < path->legs + LEGS - 1 && leg[1].begin <= time) {
        leg++;
    }
    return leg;
}

float path_place(const struct path *path, const struct axis *axis, uint32_t time) {
    struct leg now;
    const struct leg *leg = leg_at(path, time);
    modes_at(leg, axis, (float)(time - leg->begin) * SECONDS, &now);
    return place_of(&now);
}

float path_volts(const struct path *path, uint32_t time, uint32_t duration) {
    uint32_t end = time + duration;
    float sum = 0.0f;
    for (const struct leg *leg = path->legs; leg < path->legs + LEGS - 1; leg++) {
        uint32_t from = leg->begin > time ? leg->begin : time;
        uint32_t to = leg[1].begin < end ? leg[1].begin : end;
        if (from < to) {
            sum += leg->volts * (float)(to - from);
        }
    }
    return sum / (float)duration;
}

static bool between(float value, float low, float high) {
    return value >= low - ROUNDING && value <= high + ROUNDING;
}

/* Within a leg an axis turns back at most once: where its slow mode, which carries the speed, is zero. */
static bool turn_inside(const struct leg *leg, const struct leg *next, const struct axis *axis, float low, float high) {
    float end = -axis->slow_gain * leg->volts;
    if (leg->slow * end >= 0.0f) {
        return true; /* it does not turn back */
    }
    float since = log_above(-leg->slow / end) / axis->slow_rate;
    if (since >= (float)(next->begin - leg->begin) * SECONDS) {
        return true; /* the leg is over before */
    }
    return between(leg->rest + axis->rest_gain * leg->volts * since, low, high);
}

bool path_inside(const struct path *path, const struct axis *axis, float low, float high) {
    const struct leg *legs = path->legs;
    for (int i = 0; i < LEGS; i++) {
        if (!between(place_of(&legs[i]), low, high)) {
            return false;
        }
        if (i < LEGS - 1 && !turn_inside(&legs[i], &legs[i + 1], axis, low, high)) {
            return false;
        }
    }
    return between(legs[LEGS - 1].rest, low, high); /* where it coasts to in the end */
}
