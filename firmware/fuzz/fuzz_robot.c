/* libFuzzer's way into the whole core: bytes become ticks, in which a host says true and false things and encoders
 * answer well and badly. What must hold in every tick is checked, whatever was said.
 *
 * An input is a row of ticks: a byte of flags, then what they ask for.
 *   bits 0, 1  nothing, raw bytes, a whole message, or the two messages that most lead on
 *   bit 2      answers of the encoders as they come (4 bytes), else good ones that follow the motors
 *   bit 3      ticks were missed (1 byte)
 *   bits 4-7   how many more quiet ticks follow (times 4) */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "robot_state.h"

struct input {
    const uint8_t *data;
    size_t left;
};

static void draw(struct input *input, void *to, size_t count) {
    size_t given = count < input->left ? count : input->left;
    memset(to, 0, count);
    if (given > 0) {
        memcpy(to, input->data, given);
    }
    input->data += given;
    input->left -= given;
}

static uint8_t draw_byte(struct input *input) {
    uint8_t byte;
    draw(input, &byte, 1);
    return byte;
}

static const struct config gantry = {
    .c5 = {5.2955e-6f, 1.8625e-6f}, .c6 = {0.008449f, 0.002971f}, .c7 = {0.05315f, 0.05315f},
    .pulley_radius = 0.035306f, .supply = 24.0f, .most_volts = 20.0f, .x = {0.05f, 0.95f}, .y = {0.05f, 0.95f},
    .proportional = {400.0f, 400.0f}, .integral = {500.0f, 500.0f}, .derivative = {2.0f, 2.0f},
    .off_path = 0.5f, .silence = 200, .command_delay = 4500,
};

static void require(int holds) {
    if (!holds) {
        abort();
    }
}

static uint32_t crc_of_frame(const uint8_t *line, size_t count) {
    struct receiver receiver = {.count = 0};
    struct frame frame;
    require(frame_take(&receiver, line, &count, &frame) == FRAME_GOOD);
    return frame.crc;
}

static size_t lead_on(uint8_t *line) {
    struct hello hello = {PROTOCOL_MAJOR, PROTOCOL_MINOR, PROTOCOL_SCHEMA, 1, 0};
    struct home home = {0.5f, 0.5f};
    size_t count = frame_put(line, MESSAGE_HELLO, &hello);
    size_t before = count;
    count += frame_put(line + count, MESSAGE_CONFIG, &gantry);
    struct arm arm = {crc_of_frame(line + before, count - before)};
    count += frame_put(line + count, MESSAGE_HOME, &home);
    return count + frame_put(line + count, MESSAGE_ARM, &arm);
}

static size_t speak(struct input *input, uint8_t how, const struct robot *robot, uint8_t *line) {
    union {
        uint8_t bytes[128];
        struct traj traj;
    } data;
    if (how == 0) {
        return 0;
    }
    if (how == 1) {
        size_t count = draw_byte(input) % 100;
        draw(input, line, count);
        return count;
    }
    if (how == 3) {
        return lead_on(line);
    }
    const struct layout *layout = &layouts[draw_byte(input) % LAYOUTS];
    draw(input, data.bytes, layout->size); /* every structure is without gaps but hello, telemetry and event */
    if (layout->id == MESSAGE_TRAJ) {
        data.traj.apply = robot->now + data.traj.apply % 20000;
    }
    return frame_put(line, layout->id, &data);
}

static uint16_t answer(uint16_t asked, int32_t angle) {
    uint16_t word = asked == ENCODER_HEALTH ? 0x0180 : asked == ENCODER_ERRORS ? 0 : (uint16_t)(angle & 0x3FFF);
    return (uint16_t)(word | (__builtin_popcount(word) & 1) << 15);
}

static void check(const struct robot *robot, const struct robot_output *out) {
    int most = PWM_FULL;
    require(out->count <= ROBOT_SEND);
    require(robot->state <= STATE_FAULT && robot->fault <= FAULT_TICK_OVERRUN);
    require((robot->state == STATE_FAULT) == (robot->fault != FAULT_NONE));
    for (int i = 0; i < 2; i++) {
        if (robot->configured) {
            most = (int)(robot->config.most_volts / robot->config.supply * PWM_FULL + 1.0f);
        }
        require(abs(out->pwm[i]) <= most);
        require(robot->state == STATE_ARMED || robot->brake.going || out->pwm[i] == 0);
        require(isfinite(robot->place[i]) && isfinite(robot->control.integral[i]));
    }
    require(robot->state != STATE_ARMED || (robot->homed && robot->configured && robot->greeted));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static struct robot robot;
    struct input input = {data, size};
    struct robot_output out = {.count = 0};
    struct kept kept = {.crc = 0};
    uint8_t line[512];
    uint32_t zeros[ROBOT_ZEROS];
    int32_t angles[2] = {100, 200};
    uint32_t now = 0xFFFF0000u;

    robot_start(&robot, 0, 1, &kept);
    while (input.left > 0) {
        uint8_t flags = draw_byte(&input);
        for (int quiet = (flags >> 4) * 4; quiet >= 0; quiet--) {
            struct robot_input in = {.bytes = line, .zeros = zeros};
            if (quiet == 0) {
                in.count = (uint16_t)speak(&input, flags & 3, &robot, line);
                in.missed = flags & 8 ? draw_byte(&input) : 0;
            }
            in.now = now += TICK_US * (1u + in.missed);
            for (int i = 0; i < ROBOT_ZEROS; i++) {
                zeros[i] = now;
            }
            for (int i = 0; i < 2; i++) {
                angles[i] += out.pwm[i] / 8;
                in.answers[i] = answer(out.commands[i], angles[i]);
            }
            if (quiet == 0 && flags & 4) {
                draw(&input, in.answers, sizeof in.answers);
            }
            robot_step(&robot, &in, &out);
            check(&robot, &out);
        }
    }
    return 0;
}
