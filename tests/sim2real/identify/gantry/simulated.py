"""Logs of a gantry with known constants, by an engine that shares no code with the product: Euler steps of 10 us."""

from __future__ import annotations

import numba
import numpy as np

from sim2real.recording.folder import Recording, Stream

RADIUS, SUPPLY = 0.0357, 24.0
KNOWN = {
    "c6_x": 0.012, "c6_y": 0.0045, "c7_x": 0.05, "c7_y": 0.047, "friction_x": 0.1, "friction_y": 0.8,
    "friction_left": 0.55, "friction_right": 0.5, "balance": 0.0, "braking": 0.0,
}  # fmt: skip
C5 = (3.579e-6 + 1.7165e-6, 3.579e-6 - 1.7165e-6)
STEP, ROW = 1e-5, 85  # s, steps of a row
PRESLIDING = 2e-4


@numba.njit
def _path(numbers, volts, push, c5_x, c5_y, radius, presliding, step, row):
    """Places (rows, 2) [m] under volts (rows, 2) [V] of the motors and a disturbance `push` (rows, 2) [V] of the axes.

    The third order is integrated as u' = f (V - u) with f the fast pole by numpy's formula for a quadratic's roots.
    """
    c6_x, c6_y, c7_x, c7_y, f_x, f_y, f_l, f_r, balance, braking = numbers
    root_x, root_y = np.sqrt(c6_x**2 - 4 * c5_x * c7_x), np.sqrt(c6_y**2 - 4 * c5_y * c7_y)
    fast_x, fast_y = (c6_x + root_x) / 2 / c5_x, (c6_y + root_y) / 2 / c5_y
    slow_x, slow_y = (c6_x - root_x) / 2 / c5_x, (c6_y - root_y) / 2 / c5_y
    x = y = v = w = u = q = left = right = along = across = 0.0
    out = np.empty((len(volts), 2))
    for i in range(len(volts)):
        out[i, 0], out[i, 1] = x, y
        for _ in range(row):
            one, two = volts[i, 0] * (1 + balance), volts[i, 1] * (1 - balance)
            if one * left < 0:
                one *= 1 - braking * abs(left)
            if two * right < 0:
                two *= 1 - braking * abs(right)
            u += step * fast_x * (one - two - u)
            q += step * fast_y * (-one - two - q)
            force = u + push[i, 0] - f_l * left + f_r * right - f_x * along
            sideways = q + push[i, 1] + f_l * left + f_r * right - f_y * across
            v += step * (radius / 2 / c5_x / fast_x * force - slow_x * v)
            w += step * (radius / 2 / c5_y / fast_y * sideways - slow_y * w)
            x += step * v
            y += step * w
            left += step * ((v - w) - abs(v - w) * left) / presliding
            right += step * ((-v - w) - abs(v + w) * right) / presliding
            along += step * (v - abs(v) * along) / presliding
            across += step * (w - abs(w) * across) / presliding
    return out


def log(seed: int, seconds: float, noise: float = 2e-5, push: float = 0.3, **known: float) -> Recording:
    """A recording of moves at random for some `seconds`, with white `noise` [m] of the encoders and a disturbance of
    about `push` [V] that lasts some 20 ms; `known`: constants other than KNOWN."""
    random, rows = np.random.default_rng(seed), int(seconds / STEP / ROW)
    numbers = np.array(list({**KNOWN, **known}.values()))
    change = np.cumsum(random.random(rows) < 0.01)
    levels = random.uniform(-8.0, 8.0, (change[-1] + 1, 2))
    pwm = np.round(levels[change] / SUPPLY, 5)
    pushes, white = np.zeros((rows, 2)), random.normal(0.0, push, (rows, 2))
    for i in range(1, rows):
        pushes[i] = 0.96 * pushes[i - 1] + np.sqrt(1 - 0.96**2) * white[i]
    place = _path(numbers, SUPPLY * pwm, pushes, *C5, RADIUS, PRESLIDING, STEP, ROW)
    place = place + random.normal(0.0, noise, (rows, 2)) + [0.6, 0.5]
    t = STEP * ROW * np.arange(rows)
    meta = {
        "format": "puckpilot-recording/1",
        "table": {}, "puck": {}, "mallet": {}, "camera": {},
        "gantry": {"supply_V": SUPPLY, "pulley_radius_m": RADIUS},
    }  # fmt: skip
    mallet = Stream({"t": t, "mallet_x": place[:, 0], "mallet_y": place[:, 1]})
    drive = Stream({"t": t, "pwm_left": pwm[:, 0], "pwm_right": pwm[:, 1]})
    return Recording(f"log_{seed}", meta, mallet=mallet, drive=drive)
