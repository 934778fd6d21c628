#include "obey.h"

#include "curves.h"
#include "safety.h"
#include "wire.h"

#define LATEST 2000    /* us past its time, at which a trajectory still begins */
#define EARLIEST 500000 /* us ahead of its time that it is kept */

#define OBEYED (-1) /* beside enum refusal */

union body {
    struct hello hello;
    struct config config;
    struct home home;
    struct traj traj;
    struct ping ping;
};

static int take_hello(struct robot *robot, const struct hello *hello) {
    robot->greeted = hello->major == PROTOCOL_MAJOR && hello->schema == PROTOCOL_SCHEMA;
    robot->answers_hello = true;
    robot->token = hello->token;
    if (robot->greeted) {
        return OBEYED;
    }
    if (robot->state == STATE_ARMED) {
        enter(robot, STATE_IDLE); /* another host took over, and would not be understood */
    }
    return REFUSAL_WRONG_VERSION;
}

static int take_config(struct robot *robot, const struct config *config) {
    struct axis axes[2];
    if (robot->state == STATE_ARMED) {
        return REFUSAL_WRONG_STATE;
    }
    bool fits = config->x[0] < config->x[1] && config->y[0] < config->y[1] && config->most_volts <= config->supply;
    for (int i = 0; i < 2; i++) {
        fits = fits && axis_make(&axes[i], config->c5[i], config->c6[i], config->c7[i], config->pulley_radius);
    }
    if (!fits) {
        return REFUSAL_BAD_CONFIG;
    }
    if (robot->homed && config->pulley_radius != robot->config.pulley_radius) {
        robot->homed = false; /* the angles meant another place */
        if (robot->state == STATE_IDLE) {
            enter(robot, STATE_UNHOMED);
        }
    }
    robot->config = *config;
    robot->axes[0] = axes[0];
    robot->axes[1] = axes[1];
    robot->configured = true;
    return OBEYED;
}

static bool encoders_good(const struct robot *robot) {
    for (int i = 0; i < 2; i++) {
        const struct encoder *encoder = &robot->encoders[i];
        if (!encoder->seen || encoder->bad > 0 || encoder->fault != FAULT_NONE) {
            return false;
        }
    }
    return true;
}

static int take_home(struct robot *robot, const struct home *home) {
    const struct config *config = &robot->config;
    if (robot->state != STATE_UNHOMED && robot->state != STATE_IDLE) {
        return REFUSAL_WRONG_STATE;
    }
    if (!robot->configured) {
        return REFUSAL_NO_CONFIG;
    }
    if (home->x < config->x[0] || home->x > config->x[1] || home->y < config->y[0] || home->y > config->y[1]) {
        return REFUSAL_OUT_OF_RANGE;
    }
    if (!encoders_good(robot)) {
        return REFUSAL_NO_ENCODERS;
    }
    float place[2] = {home->x, home->y}, angle[2];
    pulley_angles(place, config->pulley_radius, angle);
    for (int i = 0; i < 2; i++) {
        robot->offset[i] = angle[i] - RADIANS * (float)encoder_angle(&robot->encoders[i]);
        robot->place[i] = place[i];
    }
    robot->homed = true;
    if (robot->state == STATE_UNHOMED) {
        enter(robot, STATE_IDLE);
    }
    return OBEYED;
}

static int take_arm(struct robot *robot) {
    if (!robot->greeted) {
        return REFUSAL_WRONG_VERSION;
    }
    if (robot->state != STATE_IDLE) {
        return REFUSAL_WRONG_STATE;
    }
    if (!encoders_good(robot)) {
        return REFUSAL_NO_ENCODERS;
    }
    control_start(&robot->control);
    enter(robot, STATE_ARMED);
    return OBEYED;
}

static int take_disarm(struct robot *robot) {
    if (robot->state != STATE_ARMED) {
        return REFUSAL_WRONG_STATE;
    }
    enter(robot, STATE_IDLE);
    return OBEYED;
}

static int take_clear(struct robot *robot) {
    if (robot->state != STATE_FAULT) {
        return REFUSAL_WRONG_STATE;
    }
    recover(robot);
    return OBEYED;
}

/* Where the mallet will be when a new path begins: on the path that is played then, or else where it is. */
static void place_then(const struct robot *robot, uint32_t apply, float place[2]) {
    const struct track *playing = &robot->playing;
    uint32_t time = apply - playing->traj.apply;
    bool on_it = playing->there && (int32_t)time >= 0;
    for (int i = 0; i < 2; i++) {
        place[i] = on_it ? path_place(&playing->paths[i], &robot->axes[i], time) : robot->place[i];
    }
}

static bool begins_there(const struct robot *robot, const struct traj *traj) {
    float place[2], most = robot->config.off_path;
    place_then(robot, traj->apply, place);
    float x = traj->rest[0] + traj->slow[0] + traj->fast[0] - place[0];
    float y = traj->rest[1] + traj->slow[1] + traj->fast[1] - place[1];
    return x * x + y * y <= most * most;
}

static int take_traj(struct robot *robot, const struct traj *traj) {
    const struct config *config = &robot->config;
    int32_t ahead = (int32_t)(traj->apply - robot->now);
    if (robot->state != STATE_ARMED) {
        return REFUSAL_WRONG_STATE;
    }
    if (robot->numbered && (int32_t)(traj->sequence - robot->newest) <= 0) {
        return REFUSAL_OLD_SEQUENCE;
    }
    if (robot->doubted.there) {
        return REFUSAL_BUSY;
    }
    if (traj->t1[0] > traj->t2[0] || traj->t1[1] > traj->t2[1]) {
        return REFUSAL_SWITCH_ORDER;
    }
    if (magnitude(traj->volts[0]) + magnitude(traj->volts[1]) > 2.0f * config->most_volts) {
        return REFUSAL_TOO_MANY_VOLTS;
    }
    if (ahead < -LATEST) {
        return REFUSAL_TOO_LATE;
    }
    if (ahead > EARLIEST) {
        return REFUSAL_TOO_EARLY;
    }
    robot->doubted.traj = *traj;
    robot->doubted.there = true;
    robot->vetted = 0;
    robot->newest = traj->sequence;
    robot->numbered = true;
    return OBEYED;
}

static bool stays_inside(const struct robot *robot, int axis) {
    const float *area = axis == 0 ? robot->config.x : robot->config.y;
    return path_inside(&robot->doubted.paths[axis], &robot->axes[axis], area[0], area[1]);
}

static void refuse(struct robot *robot, enum refusal why) {
    robot->doubted.there = false;
    tell(robot, NOTICE_REFUSED, (uint32_t)why | MESSAGE_TRAJ << 8);
}

void vet(struct robot *robot) {
    struct track *doubted = &robot->doubted;
    if (!doubted->there) {
        return;
    }
    int axis = robot->vetted & 1;
    switch (robot->vetted++) {
    case 0: break; /* it came in this tick, which has done enough */
    case 1:
    case 2: path_make(&doubted->paths[axis], &robot->axes[axis], &doubted->traj, axis); break;
    case 3:
    case 4:
        if (!stays_inside(robot, axis)) {
            refuse(robot, REFUSAL_LEAVES_AREA);
        }
        break;
    case 5:
        if (!begins_there(robot, &doubted->traj)) {
            refuse(robot, REFUSAL_OFF_START);
        }
        break;
    default:
        if ((int32_t)(doubted->traj.apply - robot->now) < -LATEST) {
            refuse(robot, REFUSAL_TOO_LATE);
            break;
        }
        robot->coming = *doubted;
        doubted->there = false;
    }
}

static int take_ping(struct robot *robot, const struct ping *ping, uint32_t received) {
    robot->answers_ping = true;
    robot->pong = (struct pong){.token = ping->token, .received = received};
    return OBEYED;
}

static int take(struct robot *robot, enum message id, const union body *body, uint32_t received) {
    switch (id) {
    case MESSAGE_HELLO: return take_hello(robot, &body->hello);
    case MESSAGE_CONFIG: return take_config(robot, &body->config);
    case MESSAGE_HOME: return take_home(robot, &body->home);
    case MESSAGE_ARM: return take_arm(robot);
    case MESSAGE_DISARM: return take_disarm(robot);
    case MESSAGE_ESTOP: raise_fault(robot, FAULT_ESTOP); return OBEYED;
    case MESSAGE_CLEAR: return take_clear(robot);
    case MESSAGE_TRAJ: return take_traj(robot, &body->traj);
    case MESSAGE_PING: return take_ping(robot, &body->ping, received);
    default: return OBEYED;
    }
}

static bool from_host(enum message id) {
    return id != MESSAGE_PONG && id != MESSAGE_TELEMETRY && id != MESSAGE_EVENT;
}

void obey(struct robot *robot, const struct frame *frame, uint32_t received) {
    union body body;
    enum message id = frame->layout->id;
    if (!from_host(id)) {
        return; /* an echo on the line */
    }
    bool within = wire_read(frame->layout, frame->body, &body);
    if (id == MESSAGE_HELLO && body.hello.boots != 0) {
        return; /* a board's, so an echo too */
    }
    robot->heard = received;
    int refusal = REFUSAL_OUT_OF_RANGE;
    if (within) {
        refusal = take(robot, id, &body, received);
    }
    if (refusal != OBEYED) {
        tell(robot, NOTICE_REFUSED, (uint32_t)refusal | (uint32_t)id << 8);
    }
}
