#include "wire.h"

#include <stddef.h>
#include <string.h>

/* Hosts and boards are little-endian, so numbers are copied as they are. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers would have to be turned round");

static const uint8_t sizes[] = {[FIELD_U8] = 1,  [FIELD_U16] = 2, [FIELD_U32] = 4,
                                [FIELD_I16] = 2, [FIELD_I32] = 4, [FIELD_F32] = 4};

/* A float's place among all floats: its bits without the sign, which is put to them as to a whole number. What is no
 * number lies beyond the infinities. */
static int32_t rank(union limit value) {
    int32_t size = (int32_t)(value.whole & 0x7FFFFFFFu);
    return value.whole >> 31 ? -size : size;
}

static bool within(const struct field *field, union limit value) {
    if (field->type == FIELD_F32) { /* by ranks: comparing soft floats takes ten times as long */
        return rank(value) >= rank(field->low) && rank(value) <= rank(field->high);
    }
    return value.whole >= field->low.whole && value.whole <= field->high.whole;
}

/* Copies a number of so many bytes, by a load and a store where that is one; also as a whole number. */
static union limit copy_number(uint8_t *to, const uint8_t *from, size_t size) {
    union limit value = {.whole = 0};
    switch (size) {
    case 1: memcpy(&value, from, 1); memcpy(to, &value, 1); break;
    case 2: memcpy(&value, from, 2); memcpy(to, &value, 2); break;
    default: memcpy(&value, from, 4); memcpy(to, &value, 4);
    }
    return value;
}

bool wire_read(const struct layout *layout, const uint8_t *body, void *data) {
    bool good = true;
    for (size_t i = 0; i < layout->fields; i++) {
        const struct field *field = &layout->field[i];
        size_t size = sizes[field->type];
        uint8_t *to = (uint8_t *)data + field->offset;
        for (size_t k = 0; k < field->count; k++, body += size, to += size) {
            union limit value = copy_number(to, body, size);
            good = good && within(field, value);
        }
    }
    return good;
}

void wire_write(const struct layout *layout, const void *data, uint8_t *body) {
    for (size_t i = 0; i < layout->fields; i++) {
        const struct field *field = &layout->field[i];
        size_t size = sizes[field->type];
        const uint8_t *from = (const uint8_t *)data + field->offset;
        for (size_t k = 0; k < field->count; k++, body += size, from += size) {
            copy_number(body, from, size);
        }
    }
}
