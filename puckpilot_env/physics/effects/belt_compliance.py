"""The belt gives: the mallet rides on the motor's path as a damped mass on a spring.

With the motor's path m, the mallet's x obeys `x'' = w^2 (m - x) + 2 zeta w (m' - x')`, w = 2 pi hz. Between switches m
is a ramp and two fading modes, each of which x follows in proportion; what is left rings and fades by itself. The
mallet does not pull on the motor.
"""

from __future__ import annotations

import math

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.decay import fade

_SOURCE = "toothed belts of a metre: some 10 to 50 Hz with a mallet's mass"

EFFECT = Effect(
    regime="gantry",
    law="x'' = w^2 (motor - x) + 2 zeta w (motor' - x'), w = 2 pi hz",
    rows={
        "hz": Parameter("belt_hz", "Hz", 0.0, 0.0, 60.0, "resonance of mallet and belt; 0: a rigid belt", _SOURCE),
        "zeta": Parameter("belt_zeta", "1", 0.1, 0.0, 0.95, "damping of that resonance, part of critical", _SOURCE),
    },
    depends_on=("command", "history"),
    excited_by="sharp reversals, sampled at five times the resonance or more",
    source="two masses and a spring, the motor's side driven",
)


@kernel
def transfer(w, zeta, rate):
    """How much of a motor's mode exp(-rate t) the mallet follows."""
    push = w * w - 2.0 * zeta * w * rate
    return push / (rate * rate + push)


@kernel
def ring(w, zeta, x, v, duration):
    """`(x, v)` of the mallet's own ringing, `duration` [s] on."""
    damped = w * math.sqrt(1.0 - zeta * zeta)
    fade = math.exp(-zeta * w * duration)
    cos, sin = math.cos(damped * duration), math.sin(damped * duration)
    lift = (v + zeta * w * x) / damped
    return fade * (x * cos + lift * sin), fade * (v * cos - (w * w * x + zeta * w * v) / damped * sin)


@kernel
def carried(w, zeta, x, v, start, speed, slow_rate, slow, fast_rate, fast, duration):
    """`(x, v)` of the mallet `duration` [s] on, whose motor goes along `start + speed t` and two modes, `slow` and
    `fast` [m] at the start, that fade at their rates [1/s]."""
    by_slow, by_fast = transfer(w, zeta, slow_rate) * slow, transfer(w, zeta, fast_rate) * fast
    x -= start + by_slow + by_fast
    v -= speed - slow_rate * by_slow - fast_rate * by_fast
    x, v = ring(w, zeta, x, v, duration)
    by_slow *= math.exp(-slow_rate * duration)
    by_fast *= fade(fast_rate, duration)
    return x + start + speed * duration + by_slow + by_fast, v + speed - slow_rate * by_slow - fast_rate * by_fast


@kernel
def in_pieces(p):
    """Whether the belt gives: then the mallet's path has no closed form that contacts could be found in."""
    return p.belt_hz > 0.0


@kernel
def spring(p):
    """`(w [rad/s], zeta)` of the belt; w is 0 for a rigid one."""
    return 2.0 * math.pi * p.belt_hz, p.belt_zeta
