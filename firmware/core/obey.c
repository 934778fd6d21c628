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
    struct arm arm;
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
        stand_down(robot); /* another host took over, and would not be understood */
    }
    return REFUSAL_WRONG_VERSION;
}

static int take_config(struct robot *robot, const struct config *config, uint32_t crc) {
    struct axis axes[2];
    bool fits = config->x[0] < config->x[1] && config->y[0] < config->y[1] && config->most_volts <= config->supply;
    if (!fits || !axes_make(axes, config)) {
        return REFUSAL_BAD_CONFIG;
    }
    if (robot->homed && config->pulley_radius != robot->config.pulley_radius) {
        robot->homed = false; /* the angles meant another place */
        if (robot->state == STATE_IDLE) {
            enter(robot, STATE_UNHOMED);
        }
    }
    robot->config = *config;
    robot->config_crc = crc;
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

static int take_arm(struct robot *robot, const struct arm *arm) {
    if (arm->config != robot->config_crc) {
        return REFUSAL_OTHER_CONFIG;
    }
    if (!encoders_good(robot)) {
        return REFUSAL_NO_ENCODERS;
    }
    control_start(&robot->control);
    kept_hold(robot->kept, &robot->config);
    enter(robot, STATE_ARMED);
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
    if (robot->numbered && (int32_t)(traj->sequence - robot->newest) <= 0) {
        return REFUSAL_OLD_SEQUENCE;
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

static bool stays_inside(const struct robot *robot, int axis, int leg) {
    const float *area = axis == 0 ? robot->config.x : robot->config.y;
    return leg_inside(&robot->doubted.paths[axis], leg, &robot->axes[axis], area[0], area[1]);
}

static void refuse(struct robot *robot, enum refusal why) {
    robot->doubted.there = false;
    tell(robot, NOTICE_REFUSED, (uint32_t)why | MESSAGE_TRAJ << 8);
}

#define PARTS 4 /* of looking at an axis */

/* One of them; whether the next may come. */
static bool vet_axis(struct robot *robot, int axis, int part) {
    struct track *doubted = &robot->doubted;
    struct path *path = &doubted->paths[axis];
    switch (part) {
    case 0: path_begin(path, &robot->axes[axis], &doubted->traj, axis); return true;
    case 1: path_end(path, &robot->axes[axis], &doubted->traj, axis); return true;
    case 2: return stays_inside(robot, axis, 0);
    default: return stays_inside(robot, axis, 1) && stays_inside(robot, axis, 2);
    }
}

void vet(struct robot *robot) {
    struct track *doubted = &robot->doubted;
    if (!doubted->there) {
        return;
    }
    int part = robot->vetted++;
    if (part < 2 * PARTS) {
        if (!vet_axis(robot, part & 1, part >> 1)) {
            refuse(robot, REFUSAL_LEAVES_AREA);
        }
    } else if (!begins_there(robot, &doubted->traj)) {
        refuse(robot, REFUSAL_OFF_START);
    } else if ((int32_t)(doubted->traj.apply - robot->now) < -LATEST) {
        refuse(robot, REFUSAL_TOO_LATE);
    } else {
        robot->coming = *doubted;
        doubted->there = false;
    }
}

static int take_ping(struct robot *robot, const struct ping *ping, uint32_t received) {
    robot->answers_ping = true;
    robot->pong = (struct pong){.token = ping->token, .received = received};
    return OBEYED;
}

static bool in_its_state(enum message id, enum state state) {
    switch (id) {
    case MESSAGE_CONFIG: return state != STATE_ARMED;
    case MESSAGE_HOME: return state == STATE_UNHOMED || state == STATE_IDLE;
    case MESSAGE_ARM: return state == STATE_IDLE;
    case MESSAGE_DISARM:
    case MESSAGE_TRAJ: return state == STATE_ARMED;
    case MESSAGE_CLEAR: return state == STATE_FAULT;
    default: return true;
    }
}

static int take(struct robot *robot, const struct frame *frame, const union body *body, uint32_t received) {
    switch (frame->layout->id) {
    case MESSAGE_HELLO: return take_hello(robot, &body->hello);
    case MESSAGE_CONFIG: return take_config(robot, &body->config, frame->crc);
    case MESSAGE_HOME: return take_home(robot, &body->home);
    case MESSAGE_ARM: return take_arm(robot, &body->arm);
    case MESSAGE_DISARM: stand_down(robot); return OBEYED;
    case MESSAGE_ESTOP: raise_fault(robot, FAULT_ESTOP); return OBEYED;
    case MESSAGE_CLEAR: recover(robot); return OBEYED;
    case MESSAGE_TRAJ: return take_traj(robot, &body->traj);
    default: return take_ping(robot, &body->ping, received); /* what else a host may say */
    }
}

static bool from_host(enum message id) {
    return id != MESSAGE_PONG && id != MESSAGE_TELEMETRY && id != MESSAGE_EVENT;
}

/* What is for a mallet at rest. */
static bool needs_rest(enum message id) {
    return id == MESSAGE_CONFIG || id == MESSAGE_HOME || id == MESSAGE_ARM;
}

/* Why to refuse a message without a look at its numbers, which takes its time. */
static int refused_unread(const struct robot *robot, enum message id) {
    if (id == MESSAGE_ARM && !robot->greeted) {
        return REFUSAL_WRONG_VERSION;
    }
    if (!in_its_state(id, robot->state)) {
        return REFUSAL_WRONG_STATE;
    }
    if (brake_moves(&robot->brake) && needs_rest(id)) {
        return REFUSAL_BUSY;
    }
    bool another = (id == MESSAGE_CONFIG || id == MESSAGE_HOME) && (robot->read >> id & 1);
    return another || (id == MESSAGE_TRAJ && robot->doubted.there) ? REFUSAL_BUSY : OBEYED;
}

void obey(struct robot *robot, const struct frame *frame, uint32_t received) {
    union body body;
    enum message id = frame->layout->id;
    if (!from_host(id)) {
        return; /* an echo on the line */
    }
    if (id == MESSAGE_HELLO && robot->read >> id & 1) {
        return; /* one a tick is enough of a greeting */
    }
    int refusal = refused_unread(robot, id);
    if (refusal == OBEYED) {
        robot->read |= (uint16_t)(1u << id);
        if (needs_rest(id)) {
            brake_end(&robot->brake); /* it rests by now, and both would take too long */
        }
        bool within = wire_read(frame->layout, frame->body, &body);
        if (id == MESSAGE_HELLO && body.hello.boots != 0) {
            return; /* a board's, so an echo too */
        }
        refusal = within ? take(robot, frame, &body, received) : REFUSAL_OUT_OF_RANGE;
    }
    robot->heard = received;
    if (refusal != OBEYED) {
        tell(robot, NOTICE_REFUSED, (uint32_t)refusal | (uint32_t)id << 8);
    }
}
