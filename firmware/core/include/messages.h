/* Written by `python -m firmware.generate` from firmware/protocol.toml; do not edit. */
#ifndef MESSAGES_H
#define MESSAGES_H

#include <stdint.h>

#define PROTOCOL_MAJOR 1
#define PROTOCOL_MINOR 1
#define PROTOCOL_SCHEMA 0x447F05CFu
#define MESSAGE_UNCHECKED 1 /* its CRC begins at 0, that of others at the schema */
#define MESSAGE_LONGEST 84 /* bytes of a body */

/* What the board may do. */
enum state {
    STATE_BOOT, /* has not yet read its encoders */
    STATE_UNHOMED, /* does not know where the mallet is; motors off */
    STATE_IDLE, /* knows where the mallet is; motors off, once a disarmed mallet is braked */
    STATE_ARMED, /* plays */
    STATE_FAULT, /* stopped until `clear`, after a silent host or outside its area by braking; the first reason is kept */
};

/* Why the board stopped the motors by itself. */
enum fault {
    FAULT_NONE, /* nothing happened */
    FAULT_ESTOP, /* the host said stop */
    FAULT_HOST_SILENT, /* no valid message for longer than the configuration allows */
    FAULT_ENCODER_PARITY, /* an encoder's answers had a wrong parity, several in a row */
    FAULT_ENCODER_ERROR, /* an encoder reported an error, several in a row */
    FAULT_ENCODER_STUCK, /* an encoder's line stays low or high */
    FAULT_ENCODER_FROZEN, /* an encoder's angle does not move though its motor is driven */
    FAULT_ENCODER_JUMP, /* an encoder's angle moved farther than a motor can turn */
    FAULT_OFF_PATH, /* the mallet is farther from its path than the configuration allows: blocked, swapped or reversed */
    FAULT_OUT_OF_AREA, /* the mallet is outside its area */
    FAULT_TICK_OVERRUN, /* a control tick was missed, or the clock does not go on as ticks do */
};

/* What an event is. */
enum notice {
    NOTICE_BOOTED, /* it started; detail: what reset it, as the board says */
    NOTICE_STATE, /* its state changed; detail: the new state */
    NOTICE_FAULTED, /* it stopped; detail: the fault */
    NOTICE_REFUSED, /* it did not do what a message asked; detail: the reason, and the message's id times 256 */
};

/* Why a message was not obeyed. */
enum refusal {
    REFUSAL_OUT_OF_RANGE, /* a number is outside its limits, or none */
    REFUSAL_WRONG_VERSION, /* no hello of the same version and schema came before */
    REFUSAL_NO_CONFIG, /* no configuration came before */
    REFUSAL_OTHER_CONFIG, /* the configuration held is not the one that is meant: it was lost, or another host's came */
    REFUSAL_BAD_CONFIG, /* the configuration's numbers do not fit each other */
    REFUSAL_WRONG_STATE, /* not in this state */
    REFUSAL_NO_ENCODERS, /* the encoders give no valid angle */
    REFUSAL_OLD_SEQUENCE, /* this trajectory or a newer one came before */
    REFUSAL_SWITCH_ORDER, /* the second switching time is before the first */
    REFUSAL_TOO_MANY_VOLTS, /* a motor would need more than the configuration allows */
    REFUSAL_LEAVES_AREA, /* the path leaves the mallet's area */
    REFUSAL_OFF_START, /* the path does not begin where the mallet is */
    REFUSAL_TOO_LATE, /* the time to apply it is past */
    REFUSAL_TOO_EARLY, /* the time to apply it is too far ahead */
    REFUSAL_BUSY, /* one of its kind that came just before is still being looked at, or the mallet is being braked */
};

enum message {
    MESSAGE_HELLO = 1, /* Who is there. The board answers a host's with its own. */
    MESSAGE_CONFIG = 2, /* The table and how to control it; taken in every state but ARMED. */
    MESSAGE_HOME = 3, /* The mallet stands here now, at rest (report L.2); in UNHOMED and IDLE. */
    MESSAGE_ARM = 4, /* Let the motors play; in IDLE. */
    MESSAGE_DISARM = 5, /* Brake the mallet, then motors off; in ARMED. */
    MESSAGE_ESTOP = 6, /* Motors off now, in any state. */
    MESSAGE_CLEAR = 7, /* Leave FAULT: to IDLE if the mallet's place is still known, else to UNHOMED. */
    MESSAGE_TRAJ = 8, /* A plan: volts until t1, reversed until t2, then none; from the state that the modes say. The newest wins. */
    MESSAGE_PING = 9, /* Answered at once with `pong`; keeps the host from being silent. */
    MESSAGE_PONG = 10, /* Answer to `ping`, with the board's clock. */
    MESSAGE_TELEMETRY = 11, /* How it stands, every second tick. */
    MESSAGE_EVENT = 12, /* Something happened. */
};

struct hello {
    uint8_t major; /* of the protocol's version */
    uint8_t minor;
    uint32_t schema; /* hash of this definition */
    uint32_t token; /* the host's choice; the board answers with the same */
    uint32_t boots; /* the board's choice at each start; 0 from the host */
};

struct config {
    float c5[2]; /* V s^3; of axes x, y (report E.1) */
    float c6[2]; /* V s^2 */
    float c7[2]; /* V s */
    float pulley_radius; /* m */
    float supply; /* V; what full PWM gives a motor */
    float most_volts; /* V; that a motor ever gets */
    float x[2]; /* m; area of the mallet's centre: low, high */
    float y[2]; /* m */
    float proportional[2]; /* V/m; of axes x, y */
    float integral[2]; /* V/m/s */
    float derivative[2]; /* V s/m */
    float off_path; /* m; farther from its path the mallet stops */
    uint16_t silence; /* ms; longer without a message it brakes and stops */
    uint16_t command_delay; /* us; from an order of volts until the motors obey */
};

struct home {
    float x; /* m */
    float y; /* m */
};

struct arm {
    uint32_t config; /* the CRC-32 at the end of the configuration's frame that is meant */
};

struct traj {
    uint32_t sequence; /* greater than of every one before, modulo 2^32 */
    uint32_t apply; /* us; when it begins, by the board's clock; looking at it takes 10 ms */
    uint32_t life; /* us; after it the motors are off */
    float volts[2]; /* V; of axes x, y, signed */
    uint32_t t1[2]; /* us */
    uint32_t t2[2]; /* us */
    float rest[2]; /* m; where it would coast to */
    float slow[2]; /* m; mode that fades slowly */
    float fast[2]; /* m; mode that fades fast; under 1e-4 on this gantry */
};

struct ping {
    uint32_t token;
};

struct pong {
    uint32_t token;
    uint32_t received; /* us; when the ping's last byte was read */
    uint32_t sent; /* us; when this was put together */
};

struct telemetry {
    uint32_t time; /* us */
    uint8_t state;
    uint8_t fault;
    float place[2]; /* m; of the mallet, x and y; 0 where it is not known */
    float path[2]; /* m; where its path has it */
    int16_t pwm[2]; /* of both motors, signed, of PWM_FULL */
    uint16_t angle[2]; /* of both encoders as read, of 16384 a turn */
    uint32_t sequence; /* of the trajectory that is played; 0 for none */
    uint16_t damaged; /* frames with a wrong CRC or length, modulo 2^16 */
    uint16_t lost; /* bytes lost before they were read, modulo 2^16 */
    uint16_t longest; /* us; longest tick so far */
};

struct event {
    uint32_t time; /* us */
    uint8_t code; /* of the enum notice */
    uint32_t detail;
};

/* One number of a message, or several: where it is in the structure, and what it may be. */
struct field {
    uint8_t type; /* enum field_type */
    uint8_t count;
    uint16_t offset;
    union limit {
        float real;
        uint32_t whole; /* of types without a sign */
    } low, high;
};

enum field_type {
    FIELD_U8,
    FIELD_U16,
    FIELD_U32,
    FIELD_I16,
    FIELD_I32,
    FIELD_F32,
};

struct layout {
    uint8_t id;
    uint8_t fields; /* how many */
    uint8_t size; /* bytes of the body */
    const struct field *field;
};

#define LAYOUTS 12
extern const struct layout layouts[LAYOUTS];

#endif
