"""The state of the whole microcontroller as one record, which compiled code and Unicorn's callbacks share."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import array_at, array_kernel, kernel
from sim2real.emulate.board.block_timing import TIMING, reset_timing
from sim2real.emulate.board.core import CORE, reset_core
from sim2real.emulate.memory import MEMORY
from sim2real.emulate.peripherals.as5147 import ENCODER
from sim2real.emulate.peripherals.dma import DMA, reset_dma
from sim2real.emulate.peripherals.gpio import PORT, PORT_A, PORT_B, reset_port
from sim2real.emulate.peripherals.motors import MOTORS, update_motors
from sim2real.emulate.peripherals.nvic import NVIC, reset_nvic
from sim2real.emulate.peripherals.rcc import RCC, reset_rcc
from sim2real.emulate.peripherals.spi import SPI, reset_spi
from sim2real.emulate.peripherals.systick import SYSTICK_STATE
from sim2real.emulate.peripherals.timers import COUNTER_STATE, PWM_OFFSETS, PWM_STATE, reset_counter
from sim2real.emulate.peripherals.usart import USART, reset_usart
from sim2real.emulate.peripherals.watchdog import WATCHDOG, reset_watchdog
from sim2real.emulate.refusals import REFUSAL
from sim2real.emulate.timeline import TIMELINE, clear_timeline

# until: tick until which it is run; slice: instructions after which it stops, 0 for no limit
BOARD = np.dtype(
    [
        ("memory", MEMORY), ("timeline", TIMELINE), ("core", CORE), ("nvic", NVIC), ("refusal", REFUSAL),
        ("rcc", RCC), ("ports", PORT, 2), ("pwm", PWM_STATE), ("counter", COUNTER_STATE), ("systick", SYSTICK_STATE),
        ("spi", SPI), ("encoders", ENCODER, 2), ("motors", MOTORS), ("usart", USART), ("dma", DMA),
        ("watchdog", WATCHDOG), ("timing", TIMING), ("until", np.int64), ("slice", np.int64),
    ],
    align=True,
)  # fmt: skip


@array_kernel
def board_at(address):
    """The board whose state is at an address. Compiled code takes that faster from Python than an array of records."""
    return array_at(address, 1, BOARD)[0]


@kernel
def reset_board(address, cause):
    """Reset by `cause`, one of the values of `rcc.CAUSES`. Memory keeps its contents, and bytes of the host on the line
    still arrive."""
    board = board_at(address)
    clear_timeline(board.timeline)
    reset_rcc(board.rcc, cause)
    reset_nvic(board.nvic)
    reset_port(board.ports[PORT_A])
    reset_port(board.ports[PORT_B])
    for register in range(len(PWM_OFFSETS)):
        board.pwm.values[register] = 0
    reset_counter(board)
    for register in range(3):
        board.systick.values[register] = 0
    reset_spi(board.spi)
    reset_usart(board)
    reset_dma(board.dma)
    reset_watchdog(board.watchdog)
    reset_timing(board.timing)
    update_motors(board)
    reset_core(board)
