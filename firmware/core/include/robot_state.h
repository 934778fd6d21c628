/* All that the program remembers. */
#ifndef ROBOT_STATE_H
#define ROBOT_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "brake.h"
#include "control.h"
#include "encoder.h"
#include "frame.h"
#include "gantry.h"
#include "messages.h"
#include "path.h"
#include "robot.h"

#define RADIANS 3.83495197e-4f /* of a step of an encoder: 2 pi / ENCODER_TURN */
#define NEWS 8 /* events that wait to be sent; more of them, and the oldest are dropped */

struct track {
    bool there;
    struct traj traj;
    struct path paths[2];
};

struct robot {
    uint32_t now, before; /* us: this tick, and the one before */
    uint32_t boots;
    uint8_t state; /* enum state */
    uint8_t fault; /* enum fault: the first one since the last clear */
    uint16_t ticks;

    bool greeted;    /* a hello of the same version and schema came */
    bool configured;
    struct config config;
    uint32_t config_crc; /* of its frame */
    struct axis axes[2];

    struct encoder encoders[2];
    bool homed;
    float offset[2]; /* rad, of the pulleys */
    float place[2];  /* m */

    uint16_t read;         /* messages whose numbers were looked at in this tick, bit id of each */
    uint32_t heard;        /* us: when the last message came */
    uint32_t newest;       /* sequence of the newest trajectory */
    bool numbered;         /* there was one since ARMED */
    struct track playing, coming;
    struct track doubted;  /* the newest, until it was looked at */
    uint8_t vetted;        /* parts of it that were, one a tick at most */
    bool leaps;            /* a path begins in this tick */
    struct setpoints setpoints;
    float path[2];         /* m: where the path has the mallet, whose motors obey late */
    struct control control;
    struct brake brake;    /* goes on in FAULT or IDLE, whatever the host says but estop */
    struct kept *kept;     /* holds the configuration while a motor may be driven */
    bool coasts;           /* since a reset, in BOOT: the mallet was driven then */
    int16_t pwm[2];
    uint16_t driven[2];    /* ticks that a motor was driven without its encoder moving */

    struct receiver receiver;
    uint16_t damaged, lost, longest;
    uint8_t news_first, news_count;
    struct event news[NEWS];
    bool answers_hello, answers_ping;
    uint32_t token;
    struct pong pong;
};

#endif
