#include "wire.h"

#include <float.h>
#include <stddef.h>
#include <string.h>

/* Hosts and boards are little-endian, so numbers are copied as they are. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers would have to be turned round");

static const uint8_t sizes[] = {[FIELD_U8] = 1, [FIELD_U16] = 2, [FIELD_U32] = 4,
                                [FIELD_I16] = 2, [FIELD_I32] = 4, [FIELD_F32] = 4};

static float number(enum field_type type, const void *at) {
    uint16_t half;
    uint32_t word;
    int16_t signed_half;
    int32_t signed_word;
    float real;
    switch (type) {
    case FIELD_U16: memcpy(&half, at, sizeof half); return half;
    case FIELD_U32: memcpy(&word, at, sizeof word); return (float)word;
    case FIELD_I16: memcpy(&signed_half, at, sizeof signed_half); return signed_half;
    case FIELD_I32: memcpy(&signed_word, at, sizeof signed_word); return (float)signed_word;
    case FIELD_F32: memcpy(&real, at, sizeof real); return real;
    default: return *(const uint8_t *)at;
    }
}

/* Whole numbers without limits of their own may be anything; a real one must at least be a number. */
static bool within(const struct field *field, const void *at) {
    if (field->type != FIELD_F32 && field->low == -FLT_MAX) {
        return true;
    }
    float value = number(field->type, at);
    return value >= field->low && value <= field->high; /* false for no number */
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
