/* Written by `python -m firmware.generate` from firmware/protocol.toml; do not edit. */
#include "messages.h"

#include <float.h>
#include <stddef.h>

static const struct field hello_fields[] = {
    {FIELD_U8, 1, offsetof(struct hello, major), -FLT_MAX, FLT_MAX},
    {FIELD_U8, 1, offsetof(struct hello, minor), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct hello, schema), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct hello, token), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct hello, boots), -FLT_MAX, FLT_MAX},
};

static const struct field config_fields[] = {
    {FIELD_F32, 2, offsetof(struct config, c5), 1e-09f, 0.01f},
    {FIELD_F32, 2, offsetof(struct config, c6), 1e-06f, 1.0f},
    {FIELD_F32, 2, offsetof(struct config, c7), 0.0001f, 10.0f},
    {FIELD_F32, 1, offsetof(struct config, pulley_radius), 0.005f, 0.2f},
    {FIELD_F32, 1, offsetof(struct config, supply), 5.0f, 30.0f},
    {FIELD_F32, 1, offsetof(struct config, most_volts), 0.1f, 30.0f},
    {FIELD_F32, 2, offsetof(struct config, x), -5.0f, 5.0f},
    {FIELD_F32, 2, offsetof(struct config, y), -5.0f, 5.0f},
    {FIELD_F32, 2, offsetof(struct config, proportional), 0.0f, 10000.0f},
    {FIELD_F32, 2, offsetof(struct config, integral), 0.0f, 100000.0f},
    {FIELD_F32, 2, offsetof(struct config, derivative), 0.0f, 1000.0f},
    {FIELD_F32, 1, offsetof(struct config, off_path), 0.001f, 1.0f},
    {FIELD_U16, 1, offsetof(struct config, silence), 10.0f, 1000.0f},
};

static const struct field home_fields[] = {
    {FIELD_F32, 1, offsetof(struct home, x), -5.0f, 5.0f},
    {FIELD_F32, 1, offsetof(struct home, y), -5.0f, 5.0f},
};

static const struct field traj_fields[] = {
    {FIELD_U32, 1, offsetof(struct traj, sequence), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct traj, apply), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct traj, life), 1000.0f, 5000000.0f},
    {FIELD_F32, 2, offsetof(struct traj, volts), -60.0f, 60.0f},
    {FIELD_U32, 2, offsetof(struct traj, t1), 0.0f, 10000000.0f},
    {FIELD_U32, 2, offsetof(struct traj, t2), 0.0f, 10000000.0f},
    {FIELD_F32, 2, offsetof(struct traj, rest), -10.0f, 10.0f},
    {FIELD_F32, 2, offsetof(struct traj, slow), -10.0f, 10.0f},
    {FIELD_F32, 2, offsetof(struct traj, fast), -1.0f, 1.0f},
};

static const struct field ping_fields[] = {
    {FIELD_U32, 1, offsetof(struct ping, token), -FLT_MAX, FLT_MAX},
};

static const struct field pong_fields[] = {
    {FIELD_U32, 1, offsetof(struct pong, token), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct pong, received), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct pong, sent), -FLT_MAX, FLT_MAX},
};

static const struct field telemetry_fields[] = {
    {FIELD_U32, 1, offsetof(struct telemetry, time), -FLT_MAX, FLT_MAX},
    {FIELD_U8, 1, offsetof(struct telemetry, state), -FLT_MAX, FLT_MAX},
    {FIELD_U8, 1, offsetof(struct telemetry, fault), -FLT_MAX, FLT_MAX},
    {FIELD_F32, 2, offsetof(struct telemetry, place), -FLT_MAX, FLT_MAX},
    {FIELD_F32, 2, offsetof(struct telemetry, path), -FLT_MAX, FLT_MAX},
    {FIELD_I16, 2, offsetof(struct telemetry, pwm), -FLT_MAX, FLT_MAX},
    {FIELD_U16, 2, offsetof(struct telemetry, angle), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct telemetry, sequence), -FLT_MAX, FLT_MAX},
    {FIELD_U16, 1, offsetof(struct telemetry, damaged), -FLT_MAX, FLT_MAX},
    {FIELD_U16, 1, offsetof(struct telemetry, lost), -FLT_MAX, FLT_MAX},
    {FIELD_U16, 1, offsetof(struct telemetry, longest), -FLT_MAX, FLT_MAX},
};

static const struct field event_fields[] = {
    {FIELD_U32, 1, offsetof(struct event, time), -FLT_MAX, FLT_MAX},
    {FIELD_U8, 1, offsetof(struct event, code), -FLT_MAX, FLT_MAX},
    {FIELD_U32, 1, offsetof(struct event, detail), -FLT_MAX, FLT_MAX},
};

const struct layout layouts[LAYOUTS] = {
    {MESSAGE_HELLO, 5, 14, hello_fields},
    {MESSAGE_CONFIG, 13, 82, config_fields},
    {MESSAGE_HOME, 2, 8, home_fields},
    {MESSAGE_ARM, 0, 0, NULL},
    {MESSAGE_DISARM, 0, 0, NULL},
    {MESSAGE_ESTOP, 0, 0, NULL},
    {MESSAGE_CLEAR, 0, 0, NULL},
    {MESSAGE_TRAJ, 9, 60, traj_fields},
    {MESSAGE_PING, 1, 4, ping_fields},
    {MESSAGE_PONG, 3, 12, pong_fields},
    {MESSAGE_TELEMETRY, 11, 40, telemetry_fields},
    {MESSAGE_EVENT, 3, 9, event_fields},
};
