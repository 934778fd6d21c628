/* From reset to main: vectors, memory, and what the compiler asks for. */
#include <stddef.h>
#include <stdint.h>

#include "board.h"

extern uint32_t stack_top[], data_begin[], data_end[], data_source[], bss_begin[], bss_end[];

int main(void);
_Noreturn void reset(void);
void tick_interrupt(void);
void usart_interrupt(void);
void sent_interrupt(void);
void *memcpy(void *to, const void *from, size_t count);
void *memset(void *to, int value, size_t count);

/* A word at a time, wherever it lies: this processor loads and stores them at any address. */
void *memcpy(void *restrict to, const void *restrict from, size_t count)
{
    typedef uint32_t __attribute__((may_alias, aligned(1))) word;
    uint8_t *t = to;
    const uint8_t *f = from;
    for (; count >= sizeof(word); count -= sizeof(word), t += sizeof(word), f += sizeof(word))
        *(word *)t = *(const word *)f;
    while (count--)
        *t++ = *f++;
    return to;
}

void *memset(void *to, int value, size_t count)
{
    uint8_t *t = to;
    while (count--)
        *t++ = (uint8_t)value;
    return to;
}

_Noreturn void reset(void)
{
    memcpy(data_begin, data_source, (size_t)((char *)data_end - (char *)data_begin));
    memset(bss_begin, 0, (size_t)((char *)bss_end - (char *)bss_begin));
    main();
    halt();
}

/* Exception n of the manual is entry n; interrupt n is entry 16 + n. What is not expected stops the motors: hard fault,
 * and NMI, which comes when the crystal fails. */
typedef void (*vector)(void);

__attribute__((section(".vectors"), used)) static const vector vectors[16 + 43] = {
    (vector)(uintptr_t)stack_top, reset, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt,
    tick_interrupt,
    halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, sent_interrupt, halt,
    halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt,
    halt, halt, halt, halt, halt, usart_interrupt, halt, halt, halt, halt, halt,
};
