"""What the simulator lacks in each step that a table's recordings show: measured less simulated, 0.1 s after a command.

A step is taken where the puck glides at both of its ends, within one launch, and the opponent's mallet, whose orders no
recording holds, stays away from it. The simulator begins with what was measured, and has no physics but what is true
of every table, and what is known of this one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.residual.kernels import NEAR, put_range
from puckpilot_env.residual.network import OUTPUTS, PERIOD, no_residual
from puckpilot_env.residual.tables import ResidualTables
from sim2real.recording.folder import Recording, read_recording
from sim2real.recording.table_parameters import stated_sizes
from sim2real.segmentation.local_motion import local_motion
from sim2real.segmentation.mallet_path import NO_SWITCHES, MalletPath, robot_path
from sim2real.segmentation.segments import Glide, Segments, segment

VARIANT = "match-v0"
OFF_STEP = 0.005  # s by which the next command may come sooner or later than a step after
SIDE_FRAMES = 12  # on either side of a time, that say how the puck moves then: 0.1 s at 120 Hz
LEAST_FRAMES = 5
BLOCK = 5.0  # s of a recording that are fitted, or held out, together
STATE = 12  # numbers of a step's begin, see `kernels.put_range`
SIZES = ("length", "width", "goal_width", "puck_radius", "mallet_radius")


@dataclass(frozen=True)
class Samples:
    """`inputs` (n, 18): of steps, see `network.INPUTS`; `missed` (n, 4): the puck's x, y, vx, vy as measured at their
    ends, less the simulated ones [m, m/s]; `blocks` (n,): number of the piece of a recording that each is from."""

    inputs: np.ndarray
    missed: np.ndarray
    blocks: np.ndarray

    def __len__(self) -> int:
        return len(self.missed)


@dataclass(frozen=True)
class _Step:
    """A step as measured: its `begin` (12,), see `kernels.put_range`; the robot's `action` (4,); the puck's `end`."""

    begin: np.ndarray
    action: np.ndarray
    end: np.ndarray
    block: int


def read_samples(folders: Sequence[Path], values: Mapping[str, float]) -> Samples:
    """The samples of all recordings, beside the simulator of the parameters `values`, the others at their defaults.
    ValueError, in one line, for a recording that cannot be read, or is of a table of other sizes."""
    steps: list[_Step] = []
    for folder in folders:
        recording = read_recording(folder)
        first = steps[-1].block + 1 if steps else 0
        steps += _steps(recording, first, values)
    return _simulated(steps, values)


def _steps(recording: Recording, first_block: int, values: Mapping[str, float]) -> list[_Step]:
    """The steps that a recording shows, in order of time."""
    commands, frames, robot = recording.commands, recording.frames, robot_path(recording)
    if commands is None or frames is None or robot is None:
        return []
    found, segments, opponent = [], segment(recording), _opponent(recording)
    sizes = {name: _size(recording, name, values) for name in SIZES}
    radius = sizes["puck_radius"] + sizes["mallet_radius"]
    columns = np.stack([commands[name] for name in ("x_f", "y_f", "V_x", "V_y")], axis=1)
    for row in np.flatnonzero(np.abs(np.diff(commands.t) - PERIOD) < OFF_STEP):
        t = float(commands.t[row])
        pucks = _puck_at_both(segments, t)
        mallet = robot.motion(t)
        if pucks is None or mallet is None:
            continue
        seen = _seen(recording, segments, t)
        place = opponent.at(np.array([t, *seen[:, 0]])) if len(opponent.t) > 1 else np.full((1, 2), np.nan)
        ways = np.linalg.norm(np.vstack([pucks[0][:2], seen[:, 1:]]) - place, axis=1)
        off_robot = np.linalg.norm(pucks[0][:2] - mallet[0][0])
        if not (np.isfinite(place).all() and ways.min() > radius + NEAR and off_robot > radius):
            continue
        begin = np.concatenate([pucks[0], mallet[0].ravel(), place[0]])
        action = np.concatenate([columns[row, :2], np.abs(columns[row, 2:])])
        found.append(_Step(begin, action, pucks[1], first_block + int(t / BLOCK)))
    return found


def _size(recording: Recording, name: str, values: Mapping[str, float]) -> float:
    """A size of the simulator's table; ValueError where the recording's is another."""
    simulated, stated = float(values.get(name, BY_NAME[name].default)), stated_sizes(recording).get(name)
    if stated is not None and abs(stated - simulated) > 1e-9:
        raise ValueError(f"{recording.name}: its {name} is {stated:g} m, that of the simulator {simulated:g} m")
    return simulated


def _opponent(recording: Recording) -> MalletPath:
    """The opponent's mallet, where the camera saw it."""
    frames = recording.frames
    assert frames is not None
    p = np.stack([frames["opponent_x"], frames["opponent_y"]], axis=1)
    seen = np.isfinite(p).all(axis=1)
    return MalletPath(frames.t[seen], p[seen], 0.0, (0.0, 0.0), NO_SWITCHES)


def _seen(recording: Recording, segments: Segments, t: float) -> np.ndarray:
    """(n, 3) time and place of the puck in the valid frames of the step from `t` on."""
    frames = recording.frames
    assert frames is not None
    rows = np.stack([frames.t, frames["puck_x"], frames["puck_y"]], axis=1)
    first, last = np.searchsorted(frames.t, [t, t + PERIOD])
    here = slice(int(first), int(last))
    valid = np.isfinite(rows[here]).all(axis=1) & ~segments.held[here] & ~segments.wild[here]
    return rows[here][valid]


def _puck_at_both(segments: Segments, t: float) -> tuple[np.ndarray, np.ndarray] | None:
    """The puck's x, y, vx, vy at `t` and a step later; None where it does not glide then, or not in one launch."""
    glides = [_glide_at(segments, when) for when in (t, t + PERIOD)]
    launches = [
        next((n for n, (a, b) in enumerate(segments.launches) if glide and a <= glide.start and glide.stop <= b), None)
        for glide in glides
    ]
    if glides[0] is None or glides[1] is None or launches[0] is None or launches[0] != launches[1]:
        return None
    return _motion(segments, glides[0], t), _motion(segments, glides[1], t + PERIOD)


def _glide_at(segments: Segments, when: float) -> Glide | None:
    return next((one for one in segments.glides if one.t[0] <= when <= one.t[-1]), None)


def _motion(segments: Segments, glide: Glide, when: float) -> np.ndarray:
    """(4,) by a parabola through the glide's frames around `when`."""
    at = int(np.searchsorted(glide.t, when))
    first = max(0, min(at - SIDE_FRAMES, len(glide.t) - LEAST_FRAMES))
    frames = slice(first, min(len(glide.t), max(at + SIDE_FRAMES, LEAST_FRAMES)))
    fit = local_motion(glide.t, np.stack([glide.x, glide.y], axis=1), when, frames, segments.noise)
    return np.concatenate([fit.place, fit.velocity])


def _simulated(steps: list[_Step], values: Mapping[str, float]) -> Samples:
    """The samples of steps in which play simply goes on in the simulator, too."""
    if not steps:
        return Samples(np.zeros((0, 18), np.float32), np.zeros((0, len(OUTPUTS))), np.zeros(0, np.int64))
    tables = ResidualTables(VARIANT, len(steps), no_residual(), autoreset=False, parameters=values)
    p = tables.nominal[0]
    begins = np.array([one.begin for one in steps])
    radius = p["mallet_radius"]
    low, high = np.full(2, radius), np.array([p["length"] / 2 - radius, p["width"] - radius])
    begins[:, 4:6] = np.clip(begins[:, 4:6], low, high)
    put_range(tables.states, begins)
    actions = np.empty((len(steps), 2, 4))
    actions[:, 0] = [one.action for one in steps]
    actions[:, 1, :2] = np.array([p["length"], p["width"]]) - begins[:, 10:12]
    actions[:, 1, 2:] = 0.0
    tables.step(np.clip(actions, *tables.action_bounds))
    on = tables.went_on
    then = np.stack([tables.states["puck"][name] for name in OUTPUTS], axis=1)
    missed = np.array([one.end for one in steps]) - then
    return Samples(tables.inputs[on].copy(), missed[on], np.array([one.block for one in steps])[on])
