/* The report's own packet (L.1), for who has a host that speaks it: not part of the program unless REPORT=1 is given to
 * make. A newline, 13 whole numbers and a flag, a newline: 55 bytes, taken by their number, as a byte of a number may be a
 * newline too. Its receiver finds no beginning but by counting: see README.md for what that costs. */
#ifndef REPORT_PACKET_H
#define REPORT_PACKET_H

#include <stdbool.h>
#include <stdint.h>

#define REPORT_NUMBERS 12 /* before their sum */
#define REPORT_BYTES (1 + 4 * (REPORT_NUMBERS + 1) + 1 + 1)

/* Of the axes x, y (report E.2). */
struct report_packet {
    float t1[2], t2[2];            /* s */
    float volts[2];                /* V */
    float c2[2], c3[2], c4[2];
    bool idle;
};

struct report_receiver {
    uint8_t kept[REPORT_BYTES];
    uint8_t count;
};

/* One more byte; true, if it completes a packet whose sum (modulo 2^32) is right. */
bool report_take(struct report_receiver *receiver, uint8_t byte, struct report_packet *packet);

#endif
