"""The orders in a game's recording move the mallet as it is recorded, by the gantry's differential equation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")

from puckpilot_env.parameters import TABLE
from sim2real.arena.game import PERSON, Game
from sim2real.arena.recordings.records import Records
from sim2real.recording.folder import Recording, read_recording

SECONDS = 10
HALF = 60  # ticks, half a second
EXACT = 3e-5  # m in half a second: orders are written to the microsecond, places to the micrometre


def recorded(folder: Path, names: tuple[str, str]) -> Recording:
    """The recording of a game's first seconds, in which a person's pointer goes in circles."""
    records, game = Records(folder), Game(names, 7)
    recorder = records.begin(game, 7)
    for tick in range(SECONDS * 120):
        if game.person is not None:
            game.person.aim(0.5 + 0.3 * np.cos(tick / 25), 0.5 + 0.4 * np.sin(tick / 40), tick)
        game.tick()
        recorder.add(game)
    records.leave(recorder)
    return read_recording(folder / recorder.name)


def changes(recording: Recording, axis: str) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] from which on the volts hold, nan where the orders are blank; FORMAT.md: +V to t1, -V to t2, then 0."""
    plans = recording.commands
    assert plans is not None
    found: list[tuple[float, float]] = []
    for k, until in enumerate([*plans.t[1:], np.inf]):
        volts, first, second = (plans[name][k] for name in (f"V_{axis}", f"t_{axis}1", f"t_{axis}2"))
        parts = [(0.0, volts), (first, -volts), (second, 0.0)] if np.isfinite(volts) else [(0.0, np.nan)]
        for (begin, value), end in zip(parts, [*(one[0] for one in parts[1:]), np.inf], strict=True):
            if begin < end and plans.t[k] + begin < until:
                found.append((plans.t[k] + begin, value))
    return np.array(found)[:, 0], np.array(found)[:, 1]


def driven(rates: np.ndarray, begin: float, until: np.ndarray, times: np.ndarray, volts: np.ndarray) -> np.ndarray:
    """Places [m] at the times `until` under the volts, from rest at 0 at `begin` [s]; nan from where they are blank."""
    state, places, now = np.zeros(4), [], begin
    for end in until:
        for cut in [*times[(times > now) & (times < end)], end]:
            state[3] = volts[np.searchsorted(times, now, side="right") - 1]
            state, now = expm(rates * (cut - now)) @ state, cut
        places.append(state[0])
    return np.array(places)


@pytest.mark.parametrize("names", [("veteran", "policy:champion"), (PERSON, "still")])
def test_the_orders_move_the_mallet_as_it_is_recorded(tmp_path: Path, names: tuple[str, str]) -> None:
    recording = recorded(tmp_path, names)
    mallet = recording.mallet
    assert mallet is not None and recording.commands is not None
    if PERSON not in names:  # whose pointer moves all the time
        assert recording.commands.rows < 0.4 * len(mallet.t)  # most plans are what the one before had said
    p, compared = {row.name: row.default for row in TABLE}, 0
    for axis, sign in (("x", -1.0), ("y", 1.0)):
        c5, c6, c7 = (p[f"a{k}"] + sign * p[f"b{k}"] for k in (1, 2, 3))
        rates = np.zeros((4, 4))  # of place, velocity, acceleration, volts: C5 p''' + C6 p'' + C7 p' = R/2 V (E.1)
        rates[0, 1] = rates[1, 2] = 1.0
        rates[2, 1:] = np.array([-c7, -c6, p["pulley_radius"] / 2]) / c5
        times, volts = changes(recording, axis)
        for first in range(1, len(mallet.t) - HALF, HALF):
            t = mallet.t[first : first + HALF]
            path = driven(rates, t[0], t[1:], times, volts)
            if np.isnan(path).any():
                continue
            # place, velocity and acceleration at the start are those with which the path fits best
            free = np.array([expm(rates * (one - t[0]))[0, :3] for one in t[1:]])
            seen = mallet[f"mallet_{axis}"][first + 1 : first + HALF] - path
            left = seen - free @ np.linalg.lstsq(free, seen, rcond=None)[0]
            assert np.abs(left).max() < EXACT
            compared += 1
    assert compared > SECONDS  # half of all
