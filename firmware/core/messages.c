/* Written by `python -m firmware.generate` from firmware/protocol.toml; do not edit. */
#include "messages.h"

#include <float.h>
#include <stddef.h>

static const struct field hello_fields[] = {
    {FIELD_U8, 1, offsetof(struct hello, major), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U8, 1, offsetof(struct hello, minor), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct hello, schema), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct hello, token), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct hello, boots), {.whole = 0}, {.whole = UINT32_MAX}},
};

static const struct field config_fields[] = {
    {FIELD_F32, 2, offsetof(struct config, c5), {.real = 1e-09f}, {.real = 0.01f}},
    {FIELD_F32, 2, offsetof(struct config, c6), {.real = 1e-06f}, {.real = 1.0f}},
    {FIELD_F32, 2, offsetof(struct config, c7), {.real = 0.0001f}, {.real = 10.0f}},
    {FIELD_F32, 1, offsetof(struct config, pulley_radius), {.real = 0.005f}, {.real = 0.2f}},
    {FIELD_F32, 1, offsetof(struct config, supply), {.real = 5.0f}, {.real = 30.0f}},
    {FIELD_F32, 1, offsetof(struct config, most_volts), {.real = 0.1f}, {.real = 30.0f}},
    {FIELD_F32, 2, offsetof(struct config, x), {.real = -5.0f}, {.real = 5.0f}},
    {FIELD_F32, 2, offsetof(struct config, y), {.real = -5.0f}, {.real = 5.0f}},
    {FIELD_F32, 2, offsetof(struct config, proportional), {.real = 0.0f}, {.real = 10000.0f}},
    {FIELD_F32, 2, offsetof(struct config, integral), {.real = 0.0f}, {.real = 100000.0f}},
    {FIELD_F32, 2, offsetof(struct config, derivative), {.real = 0.0f}, {.real = 1000.0f}},
    {FIELD_F32, 1, offsetof(struct config, off_path), {.real = 0.001f}, {.real = 1.0f}},
    {FIELD_U16, 1, offsetof(struct config, silence), {.whole = 10u}, {.whole = 1000u}},
    {FIELD_U16, 1, offsetof(struct config, command_delay), {.whole = 0u}, {.whole = 10000u}},
};

static const struct field home_fields[] = {
    {FIELD_F32, 1, offsetof(struct home, x), {.real = -5.0f}, {.real = 5.0f}},
    {FIELD_F32, 1, offsetof(struct home, y), {.real = -5.0f}, {.real = 5.0f}},
};

static const struct field arm_fields[] = {
    {FIELD_U32, 1, offsetof(struct arm, config), {.whole = 0}, {.whole = UINT32_MAX}},
};

static const struct field traj_fields[] = {
    {FIELD_U32, 1, offsetof(struct traj, sequence), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct traj, apply), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct traj, life), {.whole = 1000u}, {.whole = 5000000u}},
    {FIELD_F32, 2, offsetof(struct traj, volts), {.real = -60.0f}, {.real = 60.0f}},
    {FIELD_U32, 2, offsetof(struct traj, t1), {.whole = 0u}, {.whole = 10000000u}},
    {FIELD_U32, 2, offsetof(struct traj, t2), {.whole = 0u}, {.whole = 10000000u}},
    {FIELD_F32, 2, offsetof(struct traj, rest), {.real = -10.0f}, {.real = 10.0f}},
    {FIELD_F32, 2, offsetof(struct traj, slow), {.real = -10.0f}, {.real = 10.0f}},
    {FIELD_F32, 2, offsetof(struct traj, fast), {.real = -0.001f}, {.real = 0.001f}},
};

static const struct field ping_fields[] = {
    {FIELD_U32, 1, offsetof(struct ping, token), {.whole = 0}, {.whole = UINT32_MAX}},
};

static const struct field pong_fields[] = {
    {FIELD_U32, 1, offsetof(struct pong, token), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct pong, received), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct pong, sent), {.whole = 0}, {.whole = UINT32_MAX}},
};

static const struct field telemetry_fields[] = {
    {FIELD_U32, 1, offsetof(struct telemetry, time), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U8, 1, offsetof(struct telemetry, state), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U8, 1, offsetof(struct telemetry, fault), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_F32, 2, offsetof(struct telemetry, place), {.real = -FLT_MAX}, {.real = FLT_MAX}},
    {FIELD_F32, 2, offsetof(struct telemetry, path), {.real = -FLT_MAX}, {.real = FLT_MAX}},
    {FIELD_I16, 2, offsetof(struct telemetry, pwm), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U16, 2, offsetof(struct telemetry, angle), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct telemetry, sequence), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U16, 1, offsetof(struct telemetry, damaged), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U16, 1, offsetof(struct telemetry, lost), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U16, 1, offsetof(struct telemetry, longest), {.whole = 0}, {.whole = UINT32_MAX}},
};

static const struct field event_fields[] = {
    {FIELD_U32, 1, offsetof(struct event, time), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U8, 1, offsetof(struct event, code), {.whole = 0}, {.whole = UINT32_MAX}},
    {FIELD_U32, 1, offsetof(struct event, detail), {.whole = 0}, {.whole = UINT32_MAX}},
};

const struct layout layouts[LAYOUTS] = {
    {MESSAGE_HELLO, 5, 14, hello_fields},
    {MESSAGE_CONFIG, 14, 84, config_fields},
    {MESSAGE_HOME, 2, 8, home_fields},
    {MESSAGE_ARM, 1, 4, arm_fields},
    {MESSAGE_DISARM, 0, 0, NULL},
    {MESSAGE_ESTOP, 0, 0, NULL},
    {MESSAGE_CLEAR, 0, 0, NULL},
    {MESSAGE_TRAJ, 9, 60, traj_fields},
    {MESSAGE_PING, 1, 4, ping_fields},
    {MESSAGE_PONG, 3, 12, pong_fields},
    {MESSAGE_TELEMETRY, 11, 40, telemetry_fields},
    {MESSAGE_EVENT, 3, 9, event_fields},
};
