/* The main loop: each millisecond gathers what came in, lets the core take one step, and does what it says. */
#include "board.h"
#include "brake.h"
#include "registers.h"
#include "robot.h"
#include "robot_state.h"

#define READ_ANGLE 0xFFFFu
#define EXCEPTION_SYSTICK 15
#define POWER_ON BIT(27 - 24) /* PORRSTF, of what RCC_CSR says of the cause */

static struct robot robot;
static volatile uint16_t due; /* ticks so far, modulo 2^16 */

/* Not cleared at reset: whatever the memory holds at power-on, and another number after each reset. */
__attribute__((section(".noinit"))) static uint32_t boots;
__attribute__((section(".noinit"))) static struct kept kept;

void tick_interrupt(void);
void tick_interrupt(void)
{
    due++;
}

_Noreturn void halt(void)
{
    motors_off();
    for (;;)
        __asm__ volatile("wfi");
}

/* Sleeps until a tick that is not yet `served`. None is slept through: an interrupt between question and WFE sets the
 * event that lets WFE pass, which WFI would not. */
static void wait_for_tick(uint16_t served)
{
    while (due == served)
        __asm__ volatile("wfe");
}

static void tick_start(uint32_t megahertz)
{
    SCB_SHPR[EXCEPTION_SYSTICK - 4] = 0x80;
    SYSTICK->LOAD = megahertz * TICK_US - 1;
    SYSTICK->VAL = 0;
    SYSTICK->CTRL = SYSTICK_ON;
}

/* When the counter stood at `stamp`, less than 65 ms before `now`. */
static uint32_t extended(uint32_t now, uint16_t stamp)
{
    return now - (uint16_t)(now - stamp);
}

static void one_tick(uint16_t missed, struct robot_output *out)
{
    static uint32_t now, zeros[ROBOT_ZEROS];
    static uint16_t took;
    struct robot_input in = {.missed = missed, .took = took};

    encoders_ask(out->commands, in.answers);
    const struct received *got = usart_take();
    now += (uint16_t)(counter_now() - (uint16_t)now);
    for (int i = 0; i < got->zeros && i < ROBOT_ZEROS; i++)
        zeros[i] = extended(now, got->stamps[i]);
    in.now = now;
    in.lost = got->lost;
    in.bytes = got->bytes;
    in.count = got->count;
    in.zeros = zeros;

    robot_step(&robot, &in, out);
    motors_set(out->pwm);
    usart_send(out->bytes, out->count);
    took = (uint16_t)(counter_now() - (uint16_t)now);
}

int main(void)
{
    static struct robot_output out;
    uint16_t served = 0;

    RCC->APB2ENR = RCC_APB2ENR_GPIOB;
    motors_off();
    const uint32_t megahertz = clock_start();
    const uint32_t cause = RCC->CSR >> 24;
    RCC->CSR |= RCC_CSR_RMVF;
    boots = boots * 1664525u + 1013904223u;
    if (cause & POWER_ON)
        kept.crc = ~kept.crc; /* what has lost its supply may have its memory, and no mallet that moves */

    watchdog_start();
    motors_start();
    encoders_start();
    counter_start(megahertz);
    usart_start(megahertz);
    robot_start(&robot, cause, boots, &kept);
    out.commands[0] = out.commands[1] = READ_ANGLE;
    tick_start(megahertz);
    for (;;) {
        wait_for_tick(served);
        const uint16_t steps = (uint16_t)(due - served);
        served = (uint16_t)(served + steps);
        one_tick((uint16_t)(steps - 1), &out);
        watchdog_kick();
    }
}
