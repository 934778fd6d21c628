/* A stand-in for the core, by which the tests see what board and emulator do. A byte from the host is an order:
 *
 *   'p'  motors at +900 and -1800          '0'  motors off             'a'  motors follow the encoders' answers
 *   'r'  report: see below                 'z'  report zeros' stamps   'd'  ask for DIAAGC from now on
 *   'e'  ask for ERRFL from now on         'h'  hang                   'f'  read where nothing is
 *   'w'  work for some 3 ms                'x'  command with a wrong parity from now on
 *   'u'  read USART2, which is not modelled
 *   'l'  send 190 bytes                    any other  comes back
 */
#include "robot.h"
#include "robot_state.h"

static void put(struct robot_output *out, const void *what, int size)
{
    const uint8_t *bytes = what;
    for (int i = 0; i < size && out->count < ROBOT_SEND; i++)
        out->bytes[out->count++] = bytes[i];
}

static void report(const struct robot *robot, const struct robot_input *in, struct robot_output *out)
{
    const uint32_t words[9] = {robot->cause, robot->boots, robot->steps, robot->missed, robot->lost, in->now,
                               in->answers[0] | (uint32_t)in->answers[1] << 16, robot->longest,
                               robot->heard};
    put(out, words, sizeof words);
}

static void obey(struct robot *robot, uint8_t order, const struct robot_input *in, struct robot_output *out)
{
    switch (order) {
    case 'p': robot->pwm[0] = 900; robot->pwm[1] = -1800; break;
    case '0': robot->pwm[0] = robot->pwm[1] = 0; break;
    case 'a': robot->pwm[0] = in->answers[0] & 2047; robot->pwm[1] = (int16_t)-(in->answers[1] & 2047); break;
    case 'r': report(robot, in, out); break;
    case 'z': put(out, in->zeros, 4 * ROBOT_ZEROS); break;
    case 'd': robot->command = 0xFFFC; break;
    case 'e': robot->command = 0x4001; break;
    case 'x': robot->command = 0x7FFF; break;
    case 'h': for (;;) __asm__ volatile(""); break;
    case 'f': put(out, (const void *)0x60000000u, 4); break;
    case 'u': put(out, (const void *)0x40004400u, 1); break;
    case 'w': for (int i = 0; i < 40000; i++) __asm__ volatile(""); break;
    case 'l': for (int i = 0; i < 190; i++) { const uint8_t byte = (uint8_t)(i + 1); put(out, &byte, 1); } break;
    default: put(out, &order, 1);
    }
}

void robot_start(struct robot *robot, uint32_t cause, uint32_t boots, struct kept *kept)
{
    (void)kept;
    *robot = (struct robot){.cause = cause, .boots = boots, .command = 0xFFFF};
}

void robot_step(struct robot *robot, const struct robot_input *in, struct robot_output *out)
{
    robot->steps++;
    robot->missed += in->missed;
    robot->lost += in->lost;
    robot->heard += in->count;
    if (in->took > robot->longest)
        robot->longest = in->took;
    out->count = 0;
    for (int i = 0; i < in->count; i++)
        obey(robot, in->bytes[i], in, out);
    for (int i = 0; i < 2; i++) {
        out->pwm[i] = robot->pwm[i];
        out->commands[i] = robot->command;
    }
}
