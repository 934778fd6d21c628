#include "robot.h"

#include <string.h>

#include "obey.h"
#include "robot_state.h"
#include "safety.h"

#define BOOT_TICKS 20 /* that the encoders are watched before they are believed */
#define TELEMETRY_TICKS 2
#define FEW_BYTES 24 /* in a tick that brings more, hearing is work enough: looking at a trajectory waits */

void robot_start(struct robot *robot, uint32_t cause, uint32_t boots, struct kept *kept) {
    memset(robot, 0, sizeof *robot);
    robot->kept = kept;
    robot->coasts = kept_take(kept, &robot->config) && axes_make(robot->axes, &robot->config);
    robot->boots = boots != 0 ? boots : 1; /* 0 is a host's */
    robot->state = STATE_BOOT;
    encoder_start(&robot->encoders[0]);
    encoder_start(&robot->encoders[1]);
    tell(robot, NOTICE_BOOTED, cause);
}

static void read_encoders(struct robot *robot, const struct robot_input *in, struct robot_output *out) {
    float angle[2];
    for (int i = 0; i < 2; i++) {
        out->commands[i] = encoder_take(&robot->encoders[i], in->answers[i]);
        angle[i] = robot->offset[i] + RADIANS * (float)encoder_angle(&robot->encoders[i]);
    }
    if (robot->homed) {
        mallet_place(angle, robot->config.pulley_radius, robot->place);
    }
}

static void listen(struct robot *robot, const struct robot_input *in) {
    struct frame frame;
    size_t taken = 0;
    robot->read = 0;
    for (uint16_t zeros = 0; taken < in->count; zeros++) {
        if (in->bytes[taken] == 0 && robot->receiver.count == 0) {
            taken++; /* as frame_take would, with less ado: a line may bring nothing else */
            continue;
        }
        size_t count = in->count - taken;
        enum frame_result result = frame_take(&robot->receiver, in->bytes + taken, &count, &frame);
        taken += count;
        if (result == FRAME_GOOD) {
            obey(robot, &frame, zeros < ROBOT_ZEROS ? in->zeros[zeros] : in->now);
        } else if (result == FRAME_DAMAGED) {
            robot->damaged++;
        }
    }
}

/* By then an encoder gave a good angle, or was given up: after eleven ticks of bad answers at the latest. */
static void leave_boot(struct robot *robot) {
    if (robot->state == STATE_BOOT && robot->ticks > BOOT_TICKS) {
        enter(robot, STATE_UNHOMED);
    }
}

/* A mallet that was driven when the board was reset: brake it as soon as two angles of each encoder tell its speed. */
static void catch(struct robot *robot) {
    const struct encoder *encoders = robot->encoders;
    bool known = encoders[0].paced && encoders[1].paced && encoders[0].bad + encoders[1].bad == 0;
    if (robot->coasts && known && robot->state == STATE_BOOT) {
        robot->coasts = false;
        brake_start(&robot->brake);
    }
}

/* Let the newest trajectory begin whose time has come, and end what has lived. */
static void choose_track(struct robot *robot) {
    struct track *playing = &robot->playing, *coming = &robot->coming;
    if (coming->there && (int32_t)(robot->now - coming->traj.apply) >= 0) {
        if (!playing->there) {
            setpoints_start(&robot->setpoints);
        }
        *playing = *coming;
        coming->there = false;
        robot->leaps = true;
    }
    if (playing->there && robot->now - playing->traj.apply > playing->traj.life) {
        playing->there = false;
        control_start(&robot->control);
    }
}

/* Where the mallet is to be, by what the motors have obeyed by now. */
static void follow(struct robot *robot) {
    const struct track *playing = &robot->playing;
    struct setpoint due = {{robot->place[0], robot->place[1]}, false};
    if (playing->there) {
        float place[2];
        uint32_t time = robot->now - playing->traj.apply;
        for (int i = 0; i < 2; i++) {
            place[i] = path_place(&playing->paths[i], &robot->axes[i], time);
        }
        setpoints_add(&robot->setpoints, place, robot->leaps);
        due = setpoint_before(&robot->setpoints, robot->config.command_delay);
    }
    robot->leaps = false;
    if (due.leaps) {
        robot->control.going = false; /* a leap is no speed */
    }
    robot->path[0] = due.place[0];
    robot->path[1] = due.place[1];
}

static int16_t nearest(float value) {
    return (int16_t)(value + (value < 0.0f ? -0.5f : 0.5f));
}

/* Volts of the motors by which the mallet follows its path. */
static void follow_volts(struct robot *robot, float motors[2]) {
    const struct track *playing = &robot->playing;
    float forward[2], error[2];
    uint32_t time = robot->now - playing->traj.apply;
    for (int i = 0; i < 2; i++) {
        forward[i] = path_volts(&playing->paths[i], time, TICK_US);
        error[i] = robot->path[i] - robot->place[i];
    }
    control_volts(&robot->control, &robot->config, forward, error, motors);
}

/* Volts of the motors by which the mallet comes to rest. */
static void rest_volts(struct robot *robot, float motors[2]) {
    float speed[2];
    const float per_tick = RADIANS * (1e6f / TICK_US);
    float turning[2] = {(float)robot->encoders[0].step * per_tick, (float)robot->encoders[1].step * per_tick};
    mallet_place(turning, robot->config.pulley_radius, speed);
    brake_volts(&robot->brake, robot->axes, robot->config.most_volts, speed, motors);
}

static void drive(struct robot *robot) {
    float motors[2];
    robot->pwm[0] = robot->pwm[1] = 0;
    if (robot->brake.going) {
        rest_volts(robot, motors);
    } else if (robot->state == STATE_ARMED && robot->playing.there) {
        follow_volts(robot, motors);
    } else {
        return;
    }
    float per_volt = PWM_FULL / robot->config.supply;
    for (int i = 0; i < 2; i++) {
        robot->pwm[i] = nearest(motors[i] * per_volt);
    }
}

static void say(struct robot_output *out, enum message id, const void *data) {
    out->count += (uint16_t)frame_put(out->bytes + out->count, id, data);
}

static void say_telemetry(const struct robot *robot, struct robot_output *out) {
    struct telemetry telemetry = {
        .time = robot->now,
        .state = robot->state,
        .fault = robot->fault,
        .pwm = {robot->pwm[0], robot->pwm[1]},
        .angle = {robot->encoders[0].raw, robot->encoders[1].raw},
        .sequence = robot->playing.there ? robot->playing.traj.sequence : 0,
        .damaged = robot->damaged,
        .lost = robot->lost,
        .longest = robot->longest,
    };
    for (int i = 0; i < 2; i++) {
        telemetry.place[i] = robot->homed ? robot->place[i] : 0.0f;
        telemetry.path[i] = robot->homed ? robot->path[i] : 0.0f;
    }
    say(out, MESSAGE_TELEMETRY, &telemetry);
}

/* Telemetry and events take turns, an event at a time: together they would take too long. */
static void speak(struct robot *robot, struct robot_output *out, uint32_t now) {
    if (robot->ticks % TELEMETRY_TICKS == 0) {
        say_telemetry(robot, out);
    } else if (robot->news_count > 0) {
        say(out, MESSAGE_EVENT, &robot->news[robot->news_first]);
        robot->news_first = (robot->news_first + 1) % NEWS;
        robot->news_count--;
    }
    if (robot->answers_hello) {
        struct hello hello = {PROTOCOL_MAJOR, PROTOCOL_MINOR, PROTOCOL_SCHEMA, robot->token, robot->boots};
        say(out, MESSAGE_HELLO, &hello);
        robot->answers_hello = false;
    } else if (robot->answers_ping) {
        robot->pong.sent = now;
        say(out, MESSAGE_PONG, &robot->pong);
        robot->answers_ping = false;
    }
}

void robot_step(struct robot *robot, const struct robot_input *in, struct robot_output *out) {
    robot->before = robot->now;
    robot->now = in->now;
    robot->ticks++;
    robot->lost += in->lost;
    robot->longest = in->took > robot->longest ? in->took : robot->longest;
    out->count = 0;

    read_encoders(robot, in, out);
    leave_boot(robot);
    listen(robot, in);
    if (in->count <= FEW_BYTES) {
        vet(robot);
    }
    choose_track(robot);
    follow(robot);
    watch(robot, in->missed);
    catch(robot);
    drive(robot);
    if (robot->state != STATE_ARMED && !robot->brake.going) {
        kept_drop(robot->kept);
    }
    out->pwm[0] = robot->pwm[0];
    out->pwm[1] = robot->pwm[1];
    speak(robot, out, in->now);
}
