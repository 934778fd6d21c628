#include "safety.h"

#define OVER_EDGE 0.005f  /* m beyond its area, at which the mallet is stopped */
#define STRONG (PWM_FULL / 6) /* duty at which a motor that is free turns */
#define UNMOVED 2         /* of a turn in a tick: less is the encoder's noise */
#define FROZEN_TICKS 20

void tell(struct robot *robot, enum notice notice, uint32_t detail) {
    if (robot->news_count == NEWS) {
        if (notice == NOTICE_REFUSED) {
            return; /* a flood of them is not to drive out what matters */
        }
        robot->news_first = (robot->news_first + 1) % NEWS;
        robot->news_count--;
    }
    robot->news[(robot->news_first + robot->news_count++) % NEWS] =
        (struct event){.time = robot->now, .code = notice, .detail = detail};
}

void enter(struct robot *robot, enum state state) {
    robot->state = state;
    robot->playing.there = robot->coming.there = robot->doubted.there = false;
    robot->numbered = false;
    robot->driven[0] = robot->driven[1] = 0;
    tell(robot, NOTICE_STATE, state);
}

static bool place_is_lost(enum fault why) {
    return why >= FAULT_ENCODER_PARITY && why <= FAULT_OFF_PATH;
}

/* Of the faults found in play these alone leave encoders, motors and clock to be relied on. */
static bool may_brake(enum fault why) {
    return why == FAULT_HOST_SILENT || why == FAULT_OUT_OF_AREA;
}

void raise_fault(struct robot *robot, enum fault why) {
    if (place_is_lost(why)) {
        robot->homed = false;
    }
    if (may_brake(why)) {
        brake_start(&robot->brake);
    } else {
        brake_end(&robot->brake);
    }
    if (robot->state != STATE_FAULT) {
        robot->fault = why;
        tell(robot, NOTICE_FAULTED, why);
        enter(robot, STATE_FAULT);
    }
}

void stand_down(struct robot *robot) {
    enter(robot, STATE_IDLE);
    brake_start(&robot->brake);
}

void recover(struct robot *robot) {
    robot->fault = FAULT_NONE;
    for (int i = 0; i < 2; i++) {
        if (robot->encoders[i].fault != FAULT_NONE) {
            encoder_start(&robot->encoders[i]);
            robot->homed = false;
        }
    }
    enter(robot, robot->homed ? STATE_IDLE : STATE_UNHOMED);
}

static bool beyond(int32_t value, int32_t most) {
    return value > most || value < -most;
}

static enum fault frozen(struct robot *robot) {
    for (int i = 0; i < 2; i++) {
        bool driven = beyond(robot->pwm[i], STRONG) && !beyond(robot->encoders[i].step, UNMOVED - 1);
        robot->driven[i] = driven ? robot->driven[i] + 1 : 0;
        if (robot->driven[i] > FROZEN_TICKS) {
            return FAULT_ENCODER_FROZEN;
        }
    }
    return FAULT_NONE;
}

static bool outside(float value, const float area[2]) {
    return value < area[0] - OVER_EDGE || value > area[1] + OVER_EDGE;
}

static enum fault astray(const struct robot *robot) {
    const struct config *config = &robot->config;
    if (outside(robot->place[0], config->x) || outside(robot->place[1], config->y)) {
        return FAULT_OUT_OF_AREA;
    }
    float x = robot->path[0] - robot->place[0], y = robot->path[1] - robot->place[1];
    bool off = robot->playing.there && x * x + y * y > config->off_path * config->off_path;
    return off ? FAULT_OFF_PATH : FAULT_NONE;
}

static bool late(const struct robot *robot, uint16_t missed) {
    uint32_t since = robot->now - robot->before;
    return missed > 0 || since < TICK_US / 2 || since > TICK_US * 3 / 2;
}

/* The first reason not to go on while armed. */
static enum fault reason(struct robot *robot, uint16_t missed) {
    if (late(robot, missed)) {
        return FAULT_TICK_OVERRUN; /* a clock that stands still would never tell that the host is silent */
    }
    if (robot->now - robot->heard > robot->config.silence * 1000u) {
        return FAULT_HOST_SILENT;
    }
    enum fault why = frozen(robot);
    return why != FAULT_NONE ? why : astray(robot);
}

void watch(struct robot *robot, uint16_t missed) {
    if (missed > ENCODER_PATIENCE) {
        robot->homed = false; /* a motor may have turned by more than half a turn, and nobody looked */
        if (robot->state == STATE_IDLE) {
            enter(robot, STATE_UNHOMED);
        }
    }
    for (int i = 0; i < 2; i++) {
        if (robot->encoders[i].fault != FAULT_NONE) {
            raise_fault(robot, robot->encoders[i].fault);
        }
    }
    if (late(robot, missed)) {
        brake_end(&robot->brake); /* its speeds are those of ticks */
    }
    if (robot->state == STATE_ARMED) {
        enum fault why = reason(robot, missed);
        if (why != FAULT_NONE) {
            raise_fault(robot, why);
        }
    }
}
