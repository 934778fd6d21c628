/* What outlives a reset: how to brake a mallet that was driven then, and would coast on for up to half a metre. It lies
 * in memory that the start-up code does not clear. It holds something as long as a motor may be driven, is good for one
 * start, and believed by its CRC. */
#ifndef KEPT_H
#define KEPT_H

#include <stdbool.h>
#include <stdint.h>

#include "messages.h"

struct kept {
    struct config config;
    uint32_t crc;
};

/* From now on a motor may be driven, by this configuration. */
void kept_hold(struct kept *kept, const struct config *config);

/* No more. */
void kept_drop(struct kept *kept);

/* Take what was held when the board was reset, and drop it; false, if nothing was. */
bool kept_take(struct kept *kept, struct config *config);

#endif
