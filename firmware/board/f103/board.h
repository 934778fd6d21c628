/* The hardware of the Blue Pill (STM32F103C8) between main loop and registers.
 *
 * | pin  | use                | goes to                                        |
 * | ---- | ------------------ | ---------------------------------------------- |
 * | PA3  | output, idle high  | CSn of encoder 1                               |
 * | PA4  | output, idle high  | CSn of encoder 0                               |
 * | PA5  | SPI1 SCK           | CLK of both encoders (AS5147)                  |
 * | PA6  | SPI1 MISO, pull-up | MISO of both encoders                          |
 * | PA7  | SPI1 MOSI          | MOSI of both encoders                          |
 * | PA9  | USART1 TX          | RX of the USB-serial adapter, 1 Mbaud          |
 * | PA10 | USART1 RX, pull-up | TX of the USB-serial adapter                   |
 * | PB12 | output             | DIR of motor 0's driver (Cytron MD30C); 1: +   |
 * | PB13 | TIM1 CH1N          | PWM of motor 0's driver                        |
 * | PB14 | TIM1 CH2N          | PWM of motor 1's driver                        |
 * | PB15 | output             | DIR of motor 1's driver                        |
 *
 * PB13 and PB14 need a pull-down of 10 kOhm outside: in reset every pin floats. Both PWM are on pins that the chip's
 * own boot loader never drives. A broken MISO reads 0xFFFF.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

/* Of `struct robot_input`: what came over the line since the last call. */
struct received {
    uint16_t count;
    uint16_t lost;
    uint16_t zeros;                /* zero bytes that came, stamped or not */
    uint16_t stamps[8];            /* the counter when each of the first came [us] */
    uint8_t bytes[256];
};

uint32_t clock_start(void);        /* 72 MHz, or 64 MHz if the crystal fails; returns it [MHz] */
void watchdog_start(void);         /* resets after 20 ms (13 to 27) without a kick */
void watchdog_kick(void);

void motors_start(void);
void motors_set(const int16_t pwm[2]);
void motors_off(void);             /* for good: takes the pins from the timer */

void encoders_start(void);
void encoders_ask(const uint16_t commands[2], uint16_t answers[2]);

void counter_start(uint32_t megahertz);
uint16_t counter_now(void);        /* us, wraps after 65 ms */

void usart_start(uint32_t megahertz);
struct received *usart_take(void); /* valid until the next call */
void usart_send(const uint8_t *bytes, uint32_t count); /* all of them, or none if they do not fit */

_Noreturn void halt(void);         /* motors off, then wait for the watchdog */

#endif
