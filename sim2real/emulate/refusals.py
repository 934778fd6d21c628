"""What this emulator does not model, and how it says so. Compiled code cannot raise an error with a text: it notes the
number of one of these and a value, and the machine stops."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel

TEXTS = (
    "",
    "read at 0x{0:08X}{1}: not modelled",
    "write at 0x{0:08X}{1}: not modelled",
    "access to 0x{0:08X}{1}: its clock is off in RCC",
    "access of fewer than 4 bytes to 0x{0:08X}{1}: not modelled",
    "SysTick's VAL is read: not modelled",
    "SysTick's CTRL = {0}: expected 0, or 7 (on, interrupt, core's clock)",
    "TIM1_CCMR1 = 0x{0:X}: expected PWM without preload",
    "TIM1_CCER = 0x{0:X}: expected CC1NE and CC2NE alone",
    "TIM2_CNT is written: not modelled",
    "a chip select changes in the middle of a frame",
    "both encoders are selected at once",
    "SPI1_CR1 = 0x{0:04X}: expected 0x0B45 and a divider",
    "SPI1_DR is written before the last frame is over, or while SPI1 is off",
    "SPI1 sends though its pins PA5 and PA7 are not lent to it",
    "SPI1 at {0} MHz / 1000: the encoder takes 10 MHz",
    "USART1_DR, CR1 or CR3 = 0x{0:X}: not modelled; DMA sends, an interrupt receives",
    "DMA1_CCR4 = 0x{0:X}: expected bytes from memory, counting up: 0x93",
    "DMA1 channel 4 is switched off in the middle of a piece",
    "DMA1 channel 4 is switched on, but USART1 is not ready, or not where CPAR4 points",
    "DMA1 channel 4 is to send from 0x{0:08X}: there is no memory",
    "an IWDG register is written while locked: without effect",
    "the PLL is switched on at a crystal that does not run",
    "RCC_CFGR = 0x{0:08X}: expected HSI or PLL, and only APB1 divided, by 2",
    "the core is switched to a PLL that is not ready",
    "{0} MHz on APB1: it takes 36",
    "{0} MHz with too few of the flash's wait states, or above 72",
)
(
    NONE, READ, WRITE, CLOCK_OFF, NARROW, SYSTICK_VALUE, SYSTICK_CONTROL, PWM_MODE, PWM_OUTPUTS, COUNTER_WRITTEN,
    SELECT_IN_FRAME, BOTH_SELECTED, SPI_CONTROL, SPI_BUSY, SPI_PINS, SPI_SPEED, USART_WRITE, DMA_CONTROL,
    DMA_SWITCHED_OFF, DMA_NOT_READY, DMA_NO_MEMORY, WATCHDOG_LOCKED, PLL_WITHOUT_CRYSTAL, CLOCK_CONFIG, PLL_NOT_READY,
    BUS_TOO_FAST, CORE_TOO_FAST,
) = range(len(TEXTS))  # fmt: skip

REFUSAL = np.dtype([("number", np.int64), ("value", np.int64)], align=True)


class NotModelledError(Exception):
    """The program used a feature that this emulator does not model; the message names it."""


@kernel
def refuse(board, number, value):
    """Note the first refusal: a number of the above, and the value or address that it is about."""
    if board.refusal.number == NONE:
        board.refusal.number = number
        board.refusal.value = value
