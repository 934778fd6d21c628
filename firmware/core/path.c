#include "path.h"

#include "curves.h"

#define SECONDS 1e-6f /* of a microsecond */
#define ROUNDING 1e-4f /* m: more than single precision and the fast mode are off by, less than matters */

struct modes {
    float rest, slow, fast; /* m */
};

static struct modes modes_at(const struct leg *leg, const struct axis *axis, float since) {
    return (struct modes){
        .rest = leg->rest + leg->drift * since,
        .slow = leg->slow_end + leg->slow_left * decay(axis->slow_rate * since),
        .fast = leg->fast_end + leg->fast_left * decay(axis->fast_rate * since),
    };
}

static struct leg leg_from(const struct modes *modes, const struct axis *axis, uint32_t begin, float volts) {
    float slow_end = -axis->slow_gain * volts, fast_end = axis->fast_gain * volts;
    return (struct leg){
        .begin = begin, .volts = volts, .rest = modes->rest, .drift = axis->rest_gain * volts,
        .slow_end = slow_end, .slow_left = modes->slow - slow_end,
        .fast_end = fast_end, .fast_left = modes->fast - fast_end,
    };
}

void path_begin(struct path *path, const struct axis *axis, const struct traj *traj, int which) {
    uint32_t first = traj->t1[which];
    struct modes modes = {traj->rest[which], traj->slow[which], traj->fast[which]};
    path->legs[0] = leg_from(&modes, axis, 0, traj->volts[which]);
    modes = modes_at(&path->legs[0], axis, (float)first * SECONDS);
    path->legs[1] = leg_from(&modes, axis, first, -traj->volts[which]);
}

void path_end(struct path *path, const struct axis *axis, const struct traj *traj, int which) {
    uint32_t first = traj->t1[which], second = traj->t2[which];
    struct modes modes = modes_at(&path->legs[1], axis, (float)(second - first) * SECONDS);
    path->legs[2] = leg_from(&modes, axis, second, 0.0f);
}

static const struct leg *leg_at(const struct path *path, uint32_t time) {
    const struct leg *leg = path->legs;
    while (leg < path->legs + LEGS - 1 && leg[1].begin <= time) {
        leg++;
    }
    return leg;
}

float path_place(const struct path *path, const struct axis *axis, uint32_t time) {
    const struct leg *leg = leg_at(path, time);
    struct modes now = modes_at(leg, axis, (float)(time - leg->begin) * SECONDS);
    return now.rest + (now.slow + now.fast);
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

/* Where a leg begins [m]. */
static float start_of(const struct leg *leg) {
    return leg->rest + (leg->slow_end + leg->slow_left + (leg->fast_end + leg->fast_left));
}

/* Within a leg an axis turns back at most once: where its slow mode, which carries the speed, is zero. */
static bool turn_inside(const struct leg *leg, const struct leg *next, const struct axis *axis, float low, float high) {
    float end = leg->slow_end, slow = end + leg->slow_left;
    if (slow * end >= 0.0f) {
        return true; /* it does not turn back */
    }
    float since = log_above(-slow / end) / axis->slow_rate;
    if (since >= (float)(next->begin - leg->begin) * SECONDS) {
        return true; /* the leg is over before */
    }
    return between(leg->rest + leg->drift * since, low, high);
}

bool leg_inside(const struct path *path, int which, const struct axis *axis, float low, float high) {
    const struct leg *leg = &path->legs[which];
    if (!between(start_of(leg), low, high)) {
        return false;
    }
    if (which == LEGS - 1) {
        return between(leg->rest, low, high); /* where it coasts to in the end */
    }
    return turn_inside(leg, leg + 1, axis, low, high);
}
