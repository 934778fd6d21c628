"""TIM1, which generates the PWM, and TIM2, which counts microseconds."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate import refusals
from sim2real.emulate.refusals import refuse

PWM_NAME, PWM_BASE = "TIM1", 0x40012C00
PWM_OFFSETS = (
    "CR1", "", "", "", "", "EGR", "CCMR1", "", "CCER", "", "PSC", "ARR", "", "CCR1", "CCR2", "", "", "BDTR",
)  # fmt: skip
COUNTER_NAME, COUNTER_BASE = "TIM2", 0x40000000
COUNTER_OFFSETS = ("CR1", "", "", "", "", "EGR", "", "", "", "CNT", "PSC", "ARR")
CR1, EGR, CCMR1, CCER, CNT, PSC, ARR, CCR1, BDTR = 0, 5, 6, 8, 9, 10, 11, 13, 17
PWM_STATE = np.dtype([("values", np.int64, len(PWM_OFFSETS))], align=True)
# divider: of the clock, since EGR was written; began: tick at which it was switched on
COUNTER_STATE = np.dtype(
    [("values", np.int64, len(COUNTER_OFFSETS)), ("divider", np.int64), ("began", np.int64)], align=True
)
_HIGH_BELOW = 6  # the mode in which an output is high while the counter is below CCR


@kernel
def write_pwm(board, register, value):
    """Write a register of TIM1, of which only the complementary outputs are modelled; whether it changed."""
    if register == CCMR1 and value & ~0x7070:
        refuse(board, refusals.PWM_MODE, value)
        return False
    if register == CCER and value & ~0x44:
        refuse(board, refusals.PWM_OUTPUTS, value)
        return False
    values = board.pwm.values
    if register == EGR or values[register] == value & 0xFFFF:
        return False
    values[register] = value & 0xFFFF
    return True


@kernel
def pwm_duty(pwm, channel):
    """The share of time, 0 to 1, for which output 0 (CH1N) or 1 (CH2N) is high."""
    values = pwm.values
    on = values[CR1] & 1 and values[BDTR] >> 15 and values[CCER] >> (2 + 4 * channel) & 1
    if not on or values[CCMR1] >> (4 + 8 * channel) & 7 != _HIGH_BELOW:
        return 0.0
    return min(values[CCR1 + channel] / (values[ARR] + 1), 1.0)


@kernel
def reset_counter(board):
    """The state of TIM2 after a reset."""
    counter = board.counter
    for register in range(len(COUNTER_OFFSETS)):
        counter.values[register] = 0
    counter.values[ARR], counter.divider = 0xFFFF, 1


@kernel
def read_counter(board, register):
    """Read a register of TIM2, which counts up."""
    counter = board.counter
    if register != CNT or not counter.values[CR1] & 1:
        return counter.values[register]
    counted = (board.timeline.now - counter.began) // (counter.divider * board.rcc.cycle)
    return counted % (counter.values[ARR] + 1)


@kernel
def write_counter(board, register, value):
    """Write a register of TIM2; a new prescaler takes effect with a write to EGR."""
    counter = board.counter
    if register == EGR:
        counter.divider = counter.values[PSC] + 1
    elif register == CR1:
        counter.began, counter.values[CR1] = board.timeline.now, value
    elif register == CNT:
        refuse(board, refusals.COUNTER_WRITTEN, 0)
    else:
        counter.values[register] = value & 0xFFFF
