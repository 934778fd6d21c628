"""Where registers are, and what an access to one does."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate import refusals
from sim2real.emulate.board.passing import pass_until
from sim2real.emulate.peripherals import dma, gpio, nvic, rcc, spi, systick, timers, usart, watchdog
from sim2real.emulate.peripherals.dma import read_dma, write_dma
from sim2real.emulate.peripherals.gpio import PORT_A, PORT_B, read_port, write_port
from sim2real.emulate.peripherals.motors import update_motors
from sim2real.emulate.peripherals.nvic import read_nvic, write_nvic
from sim2real.emulate.peripherals.rcc import rcc_polled_until, read_rcc, write_rcc
from sim2real.emulate.peripherals.spi import read_spi, select_encoder, spi_polled_until, write_spi
from sim2real.emulate.peripherals.systick import read_systick, write_systick
from sim2real.emulate.peripherals.timers import read_counter, write_counter, write_pwm
from sim2real.emulate.peripherals.usart import read_usart, write_usart
from sim2real.emulate.peripherals.watchdog import read_watchdog, watchdog_polled_until, write_watchdog
from sim2real.emulate.refusals import refuse

PERIPHERALS, PERIPHERALS_SIZE = 0x40000000, 0x24000
SYSTEM, SYSTEM_SIZE = 0xE000E000, 0x1000
_ROWS = (  # name, address, registers one every four bytes ("" is not modelled), and the gate of the clock in RCC
    (rcc.NAME, rcc.BASE, rcc.OFFSETS, None),
    (rcc.FLASH_NAME, rcc.FLASH_BASE, rcc.FLASH_OFFSETS, None),
    (gpio.NAMES[PORT_A], gpio.BASES[PORT_A], gpio.OFFSETS, (rcc.APB2ENR, 2)),
    (gpio.NAMES[PORT_B], gpio.BASES[PORT_B], gpio.OFFSETS, (rcc.APB2ENR, 3)),
    (timers.PWM_NAME, timers.PWM_BASE, timers.PWM_OFFSETS, (rcc.APB2ENR, 11)),
    (timers.COUNTER_NAME, timers.COUNTER_BASE, timers.COUNTER_OFFSETS, (rcc.APB1ENR, 0)),
    (spi.NAME, spi.BASE, spi.OFFSETS, (rcc.APB2ENR, 12)),
    (usart.NAME, usart.BASE, usart.OFFSETS, (rcc.APB2ENR, 14)),
    (dma.NAME, dma.BASE, dma.OFFSETS, (rcc.AHBENR, 0)),
    (watchdog.NAME, watchdog.BASE, watchdog.OFFSETS, None),
    (systick.NAME, systick.BASE, systick.OFFSETS, None),
)
_RCC, _FLASH, _PORT_A, _PORT_B, _PWM, _COUNTER, _SPI, _USART, _DMA, _WATCHDOG, _SYSTICK = range(len(_ROWS))
_UNKNOWN = -1
REGISTERS = {
    f"{name}_{register}": base + 4 * index
    for name, base, offsets, _ in _ROWS
    for index, register in enumerate(offsets)
    if register
}
_NAMES = {address: name for name, address in REGISTERS.items()}
_BASES = np.array([base for _, base, _, _ in _ROWS])
_GATES = np.array([gate or (_UNKNOWN, 0) for *_, gate in _ROWS])


def describe(number: int, value: int) -> str:
    """What a refusal says, of a value or of an address."""
    name = f" ({_NAMES[value]})" if value in _NAMES else ""
    return refusals.TEXTS[number].format(value, name)


def _rows_of(begin: int, size: int) -> np.ndarray:
    """Of each word from an address on, the row of its peripheral, or _UNKNOWN."""
    rows = np.full(size // 4, _UNKNOWN, np.int8)
    for number, (_, base, offsets, _) in enumerate(_ROWS):
        for index, register in enumerate(offsets):
            if register and begin <= base < begin + size:
                rows[(base - begin) // 4 + index] = number
    return rows


_AT_PERIPHERALS, _AT_SYSTEM = _rows_of(PERIPHERALS, PERIPHERALS_SIZE), _rows_of(SYSTEM, SYSTEM_SIZE)


@kernel
def _row(address):
    if SYSTEM <= address < SYSTEM + SYSTEM_SIZE:
        return _AT_SYSTEM[(address - SYSTEM) // 4]
    return _AT_PERIPHERALS[(address - PERIPHERALS) // 4]


@kernel
def _clocked(board, row):
    register, bit = _GATES[row, 0], _GATES[row, 1]
    return register == _UNKNOWN or board.rcc.values[register] >> bit & 1 != 0


@kernel
def _refused(board, row, address, size, why):
    """Whether an access is refused: of a register that is not modelled, has no clock, or is taken in part."""
    if row == _UNKNOWN or address % 4:
        refuse(board, why, address)
    elif not _clocked(board, row):
        refuse(board, refusals.CLOCK_OFF, address)
    elif size != 4:
        refuse(board, refusals.NARROW, address)
    else:
        return False
    return True


@kernel
def load(board, address, size):
    """Read so many bytes at an address as the program does."""
    row = _row(address)
    if row == _UNKNOWN and address >= SYSTEM:
        return read_nvic(board, address - nvic.BASE, size)
    if _refused(board, row, address, size, refusals.READ):
        return 0
    register = (address - _BASES[row]) // 4
    polled_until = 0
    if row == _SPI:
        polled_until = spi_polled_until(board, register)
    elif row == _WATCHDOG:
        polled_until = watchdog_polled_until(board, register)
    elif row == _RCC:
        polled_until = rcc_polled_until(board, register)
    if polled_until > board.timeline.now:
        pass_until(board, polled_until)
    return _read(board, row, register)


@kernel
def _read(board, row, register):
    if row == _SPI:
        return read_spi(board, register)
    if row == _USART:
        return read_usart(board, register)
    if row == _COUNTER:
        return read_counter(board, register)
    if row == _PORT_A:
        return read_port(board.ports[PORT_A], register)
    if row == _PORT_B:
        return read_port(board.ports[PORT_B], register)
    if row == _DMA:
        return read_dma(board, register)
    if row == _PWM:
        return board.pwm.values[register]
    if row == _WATCHDOG:
        return read_watchdog(board, register)
    if row == _SYSTICK:
        return read_systick(board, register)
    return read_rcc(board, register) if row == _RCC else board.rcc.flash


@kernel
def store(board, address, value, size):
    """Write so many bytes at an address as the program does."""
    row = _row(address)
    if row == _UNKNOWN and address >= SYSTEM:
        write_nvic(board, address - nvic.BASE, value, size)
    elif not _refused(board, row, address, size, refusals.WRITE):
        _write(board, row, (address - _BASES[row]) // 4, value)


@kernel
def _write(board, row, register, value):
    if row == _PORT_A:
        if write_port(board.ports[PORT_A], register, value):
            select_encoder(board)
    elif row == _PORT_B:
        if write_port(board.ports[PORT_B], register, value):
            update_motors(board)
    elif row == _PWM:
        if write_pwm(board, register, value):
            update_motors(board)
    elif row == _SPI:
        write_spi(board, register, value)
    elif row == _DMA:
        write_dma(board, register, value)
    elif row == _WATCHDOG:
        write_watchdog(board, register, value)
    elif row == _USART:
        write_usart(board, register, value)
    elif row == _COUNTER:
        write_counter(board, register, value)
    elif row == _SYSTICK:
        write_systick(board, register, value)
    elif row == _RCC:
        write_rcc(board, register, value)
    else:
        board.rcc.flash = value
