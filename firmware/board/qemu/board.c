/* QEMU's machine netduino2, an STM32F205 whose processor is a Cortex-M3 too: the core that is flashed, with its start-up
 * code and memory, while the host plays all other hardware. They talk over USART1 in lock-step, little endian: one byte
 * when the line is open; a `struct start`; then for each tick what comes in, and the `struct robot_output` that follows. */
#include <stddef.h>

#include "board.h"
#include "registers.h"
#include "robot.h"
#include "robot_state.h"

#define LINE ((struct usart *)0x40011000u)
#define NVIC_ICPR ((reg *)0xE000E280u)
#define SCB_AIRCR (*(reg *)0xE000ED0Cu)
#define RESET_REQUEST 0x05FA0004u

struct start {
    uint32_t cause, boots;
};

struct tick {
    uint32_t now;
    uint16_t missed, lost, answers[2], took, count, stamped; /* so many bytes follow, then the stamps of so many zeros */
};

void tick_interrupt(void) __attribute__((alias("halt")));
void usart_interrupt(void) __attribute__((alias("halt")));
void sent_interrupt(void) __attribute__((alias("halt")));

/* QEMU, told not to reboot, ends: whatever is not expected is seen by the host. */
_Noreturn void halt(void)
{
    SCB_AIRCR = RESET_REQUEST;
    for (;;) {
    }
}

static void line_open(void)
{
    __asm__ volatile("cpsid i");
    NVIC_ISER[IRQ_USART1 / 32] = BIT(IRQ_USART1 % 32);
    LINE->CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
}

/* An interrupt that is masked ends its sleep all the same. To look at SR again and again would slow QEMU's own work. */
static void take(void *to, size_t count)
{
    for (uint8_t *at = to; count--; at++) {
        while (!(LINE->SR & USART_SR_RXNE))
            __asm__ volatile("wfi");
        *at = (uint8_t)LINE->DR;
        NVIC_ICPR[IRQ_USART1 / 32] = BIT(IRQ_USART1 % 32);
    }
}

/* QEMU sends a byte in no time. */
static void give(const void *from, size_t count)
{
    for (const uint8_t *at = from; count--; at++)
        LINE->DR = *at;
}

static void one_tick(struct robot *robot, struct robot_output *out)
{
    static uint8_t bytes[sizeof((struct received *)0)->bytes];
    static uint32_t zeros[ROBOT_ZEROS];
    struct tick tick;

    take(&tick, sizeof tick);
    if (tick.count > sizeof bytes || tick.stamped > ROBOT_ZEROS)
        halt();
    take(bytes, tick.count);
    take(zeros, tick.stamped * sizeof zeros[0]);
    const struct robot_input in = {
        .now = tick.now, .missed = tick.missed, .lost = tick.lost, .answers = {tick.answers[0], tick.answers[1]},
        .bytes = bytes, .count = tick.count, .zeros = zeros, .took = tick.took,
    };
    robot_step(robot, &in, out);
    give(out, offsetof(struct robot_output, bytes) + out->count);
}

int main(void)
{
    static struct robot robot;
    static struct robot_output out;
    static struct kept kept;
    struct start start;

    line_open();
    give("", 1);
    take(&start, sizeof start);
    robot_start(&robot, start.cause, start.boots, &kept);
    for (;;)
        one_tick(&robot, &out);
}
