#include "report_packet.h"

#include <string.h>

#define END '\n'
#define COARSE 1e-4f /* of times and voltages */
#define FINE 1e-8f   /* of the constants */

static void scale(float to[2], const int32_t from[2], float unit) {
    to[0] = (float)from[0] * unit;
    to[1] = (float)from[1] * unit;
}

static bool unpack(const uint8_t *bytes, struct report_packet *packet) {
    int32_t numbers[REPORT_NUMBERS + 1];
    uint32_t sum = 0;
    memcpy(numbers, bytes, sizeof numbers);
    for (int i = 0; i < REPORT_NUMBERS; i++) {
        sum += (uint32_t)numbers[i];
    }
    if (sum != (uint32_t)numbers[REPORT_NUMBERS]) {
        return false;
    }
    scale(packet->t1, numbers, COARSE);
    scale(packet->t2, numbers + 2, COARSE);
    scale(packet->volts, numbers + 4, COARSE);
    scale(packet->c2, numbers + 6, FINE);
    scale(packet->c3, numbers + 8, FINE);
    scale(packet->c4, numbers + 10, FINE);
    packet->idle = bytes[sizeof numbers] != 0;
    return true;
}

bool report_take(struct report_receiver *receiver, uint8_t byte, struct report_packet *packet) {
    receiver->kept[receiver->count++] = byte;
    if (receiver->count < REPORT_BYTES) {
        return false;
    }
    receiver->count = 0;
    bool framed = receiver->kept[0] == END && byte == END;
    return framed && unpack(receiver->kept + 1, packet);
}
