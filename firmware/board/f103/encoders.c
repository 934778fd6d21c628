/* Two AS5147 on one SPI bus. An encoder answers a command in the frame after it, so each is asked twice. */
#include "board.h"
#include "registers.h"

#define NOTHING 0xC000u /* a read of address 0, with its parity */

static const uint32_t select[2] = {BIT(4), BIT(3)};

void encoders_start(void)
{
    GPIOA->ODR = select[0] | select[1] | BIT(6) | BIT(10); /* idle high, and pull-ups of MISO and RX */
    GPIOA->CRL = 0x00000444u | PIN_OUT << 12 | PIN_OUT << 16 | PIN_PERIPHERAL << 20 | PIN_PULLED << 24
                 | PIN_PERIPHERAL << 28;
    SPI1->CR1 = SPI_CR1_CPHA | SPI_CR1_MSTR | SPI_CR1_DIV16 | SPI_CR1_SSI | SPI_CR1_SSM | SPI_CR1_DFF16 | SPI_CR1_SPE;
}

/* At 4.5 MHz the encoder's 350 ns before, after and between frames are a clock period and the writes around it. */
static uint16_t frame(uint32_t pin, uint16_t command)
{
    GPIOA->BSRR = pin << 16;
    for (volatile int i = 0; i < 4; i++) {
    }
    SPI1->DR = command;
    while (!(SPI1->SR & SPI_SR_RXNE)) {
    }
    const uint16_t answer = (uint16_t)SPI1->DR;
    for (volatile int i = 0; i < 4; i++) {
    }
    GPIOA->BSRR = pin;
    return answer;
}

void encoders_ask(const uint16_t commands[2], uint16_t answers[2])
{
    frame(select[0], commands[0]);
    frame(select[1], commands[1]);
    answers[0] = frame(select[0], NOTHING);
    answers[1] = frame(select[1], NOTHING);
}
