/* A message's structure from and to the bytes of its body, by its layout. */
#ifndef WIRE_H
#define WIRE_H

#include <stdbool.h>
#include <stdint.h>

#include "messages.h"

/* Fill data from a body of layout->size bytes. False, where a number is outside its limits, or none. */
bool wire_read(const struct layout *layout, const uint8_t *body, void *data);

/* Write data as a body of layout->size bytes. */
void wire_write(const struct layout *layout, const void *data, uint8_t *body);

#endif
