#include "brake.h"

#include "crc32.h"

/* Another protocol may have another configuration. */
static uint32_t crc_of(const struct config *config) {
    return crc32(PROTOCOL_SCHEMA, (const uint8_t *)config, sizeof *config);
}

void kept_hold(struct kept *kept, const struct config *config) {
    kept->config = *config;
    kept->crc = crc_of(&kept->config);
}

void kept_drop(struct kept *kept) {
    kept->config.supply = 0.0f; /* which no configuration has: so its CRC is wrong, whatever it was */
}

bool kept_take(struct kept *kept, struct config *config) {
    bool held = kept->crc == crc_of(&kept->config);
    if (held) {
        *config = kept->config;
    }
    kept_drop(kept);
    return held;
}
