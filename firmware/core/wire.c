#include "wire.h"

#include <stddef.h>
#include <string.h>

/* Hosts and boards are little-endian, so numbers are copied as they are. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers would have to be turned round");

static const uint8_t sizes[] = {[FIELD_U8] = 1,  [FIELD_U16] = 2, [FIELD_U32] = 4,
                                [FIELD_I16] = 2, [FIELD_I32] = 4, [FIELD_F32] = 4};

static bool within(const struct field *field, const uint8_t *at) {
    union limit value = {.whole = 0};
    if (field->type == FIELD_I16 || field->type == FIELD_I32) {
        return true; /* these have no limits */
    }
    memcpy(&value, at, sizes[field->type]);
    if (field->type == FIELD_F32) {
        return value.real >= field->low.real && value.real <= field->high.real; /* false for no number */
    }
    return value.whole >= field->low.whole && value.whole <= field->high.whole;
}

bool wire_read(const struct layout *layout, const uint8_t *body, void *data) {
    bool good = true;
    for (size_t i = 0; i < layout->fields; i++) {
        const struct field *field = &layout->field[i];
        size_t size = sizes[field->type];
        for (size_t k = 0; k < field->count; k++) {
            good = good && within(field, body + k * size);
        }
        memcpy((uint8_t *)data + field->offset, body, size * field->count);
        body += size * field->count;
    }
    return good;
}

void wire_write(const struct layout *layout, const void *data, uint8_t *body) {
    for (size_t i = 0; i < layout->fields; i++) {
        const struct field *field = &layout->field[i];
        size_t size = (size_t)sizes[field->type] * field->count;
        memcpy(body, (const uint8_t *)data + field->offset, size);
        body += size;
    }
}
