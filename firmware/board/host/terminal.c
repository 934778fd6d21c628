/* The core as a program of this machine, behind a pseudo-terminal whose name it prints: a board to talk to where nothing
 * but a C compiler is. Its gantry is ideal: a mallet that is where its path has it. Its time is its own, a millisecond a
 * step, and goes as fast as the machine's where that has time for it; so no step is ever missed. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "robot_state.h"

#define HEALTHY 0x0180 /* DIAAGC: it runs, at a middle gain */
#define AT_ONCE 128    /* bytes a step: more than a line of 921600 baud brings */

struct board {
    struct robot robot;
    struct kept kept;
    struct robot_input in;
    struct robot_output out;
    uint32_t zeros[ROBOT_ZEROS];
    uint8_t bytes[AT_ONCE];
    int32_t turned[2]; /* of the encoders */
};

/* A raw terminal's own end; -1 if there is none. The other end stays open, so that hosts may come and go. */
static int terminal_open(void) {
    struct termios raw;
    int own = posix_openpt(O_RDWR | O_NOCTTY);
    if (own < 0 || grantpt(own) != 0 || unlockpt(own) != 0) {
        return -1;
    }
    int other = open(ptsname(own), O_RDWR | O_NOCTTY);
    if (other < 0 || tcgetattr(other, &raw) != 0) {
        return -1;
    }
    cfmakeraw(&raw);
    if (tcsetattr(other, TCSANOW, &raw) != 0 || fcntl(own, F_SETFL, O_NONBLOCK) != 0) {
        return -1;
    }
    return own;
}

static void move(struct board *board) {
    const struct robot *robot = &board->robot;
    float angle[2];
    if (robot->state != STATE_ARMED || !robot->playing.there) {
        return;
    }
    pulley_angles(robot->path, robot->config.pulley_radius, angle);
    for (int i = 0; i < 2; i++) {
        board->turned[i] = (int32_t)lroundf((angle[i] - robot->offset[i]) / RADIANS);
    }
}

static uint16_t answer(uint16_t command, int32_t turned) {
    uint16_t value = 0;
    if (command == ENCODER_ANGLE) {
        value = (uint16_t)turned & (ENCODER_TURN - 1);
    } else if (command == ENCODER_HEALTH) {
        value = HEALTHY;
    }
    return value | (uint16_t)(__builtin_parity(value) << 15);
}

static void step(struct board *board, int line) {
    ssize_t count = read(line, board->bytes, AT_ONCE);
    board->in.now += TICK_US;
    board->in.count = count > 0 ? (uint16_t)count : 0;
    for (int i = 0; i < ROBOT_ZEROS; i++) {
        board->zeros[i] = board->in.now;
    }
    move(board);
    for (int i = 0; i < 2; i++) {
        board->in.answers[i] = answer(board->out.commands[i], board->turned[i]);
    }
    robot_step(&board->robot, &board->in, &board->out);
    if (write(line, board->out.bytes, board->out.count) < 0) {
        return; /* nobody reads: as on a real line, it is lost */
    }
}

int main(void) {
    static struct board board;
    struct timespec next;
    int line = terminal_open();
    if (line < 0) {
        perror("a pseudo-terminal");
        return 1;
    }
    puts(ptsname(line)); /* first, and alone on its line: for programs */
    fflush(stdout);
    fputs("the board is there until Ctrl-C: puckpilot link test, with this name\n", stderr);
    board.in.bytes = board.bytes;
    board.in.zeros = board.zeros;
    clock_gettime(CLOCK_MONOTONIC, &next);
    robot_start(&board.robot, 0, (uint32_t)next.tv_nsec, &board.kept);
    for (;;) {
        step(&board, line);
        next.tv_nsec += 1000 * TICK_US;
        if (next.tv_nsec >= 1000000000) {
            next.tv_nsec -= 1000000000;
            next.tv_sec++;
        }
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
    }
}
