/* CRC-32 as zlib computes it (reflected 0xEDB88320). */
#ifndef CRC32_H
#define CRC32_H

#include <stddef.h>
#include <stdint.h>

/* The CRC of count bytes, going on from start, which is the CRC of what came before, or any number to begin at. */
uint32_t crc32(uint32_t start, const uint8_t *bytes, size_t count);

#endif
