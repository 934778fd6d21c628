"""Whether a player could play on a real gantry: the measures of the Robot Air Hockey Challenge, for this robot.

The challenge (Liu et al., "A Retrospective on the Robot Air Hockey Challenge", NeurIPS datasets and benchmarks 2024)
counts violations of the table's edges and of joint and motor limits, jerky commands, and slow decisions. Here every
plan keeps within the voltage and the area by construction, so the measures are how much of the voltage a player uses,
and how close to the edges it comes.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from agents.evaluation.gantry_load import peak_accelerations
from baselines.matches.match import Contestant, play
from baselines.player import Player, Seat
from baselines.ratings.intervals import IntervalEstimate, paired_win_rate
from puckpilot_env.game.sensing import ESTIMATED
from puckpilot_env.tables import Tables
from puckpilot_env.variants import Variant, find_variant

DELAYS = (0.0, 0.02, 0.04, 0.06)  # s, from exposure to a usable position
NOISES = (0.0, 0.0005, 0.001, 0.002)  # m, white, of each measured position
CAMERA_ERRORS = (
    "camera_latency", "camera_noise", "beam_noise", "beam_width", "camera_error", "dropped_frames", "held_frames",
)  # fmt: skip
TIMED_DECISIONS = 2000


@dataclass(frozen=True)
class Deployability:
    """A player's load on the gantry, over all decisions of some games, and the time of a decision.

    - `wall_margin_m`: 1st percentile of the distance [m] from the mallet's rim to the nearest edge of its half.
    - `voltage_share`, `voltage_most`: mean and maximum of the commanded voltage, as shares of the highest allowed.
    - `acceleration_m_s2`: 99th percentile over decisions of the peak acceleration [m/s^2] until the next decision.
    - `jitter_m`: mean change [m] of the commanded position between decisions.
    - `decision_us`: median time [us] of one decision at one table.
    """

    wall_margin_m: float
    voltage_share: float
    voltage_most: float
    acceleration_m_s2: float
    jitter_m: float
    decision_us: float

    def as_dict(self) -> dict[str, float]:
        """The measures by name, as JSON can hold them."""
        return asdict(self)


@dataclass(frozen=True)
class Robustness:
    """Share of decisive games won against `opponent` when both players see the table through a camera.

    `delays`: pairs of camera delay [s] and share; `noises`: pairs of noise [m] and share.
    """

    opponent: str
    delays: tuple[tuple[float, IntervalEstimate], ...]
    noises: tuple[tuple[float, IntervalEstimate], ...]

    def as_dict(self) -> dict[str, object]:
        """As JSON can hold it; "at" is the delay or the noise."""
        return {
            "opponent": self.opponent,
            "delay_s": [{"at": at, **rate.as_dict()} for at, rate in self.delays],
            "noise_m": [{"at": at, **rate.as_dict()} for at, rate in self.noises],
        }


def measure_deployability(first: Contestant, opponent: Contestant, games: int, seed: int) -> Deployability:
    """Measure `first` over `games` games of match-v0 against `opponent`, and time its decisions."""
    log = _StepLog()
    play("match-v0", first, opponent, max(games, 1), seed, watch=log.add)
    return log.summary(first)


class _StepLog:
    """Actions, positions and accelerations of player 0 at each step of every game."""

    def __init__(self) -> None:
        self.actions: list[NDArray[np.float32]] = []
        self.positions: list[NDArray[np.float32]] = []
        self.peaks: list[NDArray[np.float64]] = []
        self.running: list[NDArray[np.bool_]] = []
        self.tables: Tables | None = None

    def add(self, tables: Tables, actions: NDArray[np.float32]) -> None:
        before = self.running[-1] if self.running else np.ones(len(tables), np.bool_)
        self.running.append(before & ~(tables.terminated | tables.truncated))
        self.tables = tables
        self.actions.append(actions[:, 0].copy())
        self.positions.append(tables.observations[:, 0, :2].copy())  # of the mallet
        self.peaks.append(peak_accelerations(tables, actions))

    def summary(self, player: Contestant) -> Deployability:
        assert self.tables is not None  # a game has at least one step
        actions, positions, running = np.stack(self.actions), np.stack(self.positions), np.stack(self.running)
        p = self.tables.nominal[0]
        x, y = positions[..., 0], positions[..., 1]
        edges = np.stack([x, p["length"] / 2 - x, y, p["width"] - y]).min(axis=0) - p["mallet_radius"]
        volts = actions[running, 2:] / self.tables.action_bounds[1, 2:]
        moved = np.linalg.norm(np.diff(actions[..., :2], axis=0), axis=-1)
        return Deployability(
            wall_margin_m=float(np.percentile(edges[running], 1)),
            voltage_share=float(volts.mean()),
            voltage_most=float(volts.max()),
            acceleration_m_s2=float(np.percentile(np.stack(self.peaks)[running], 99)),
            jitter_m=float(moved[running[1:]].mean()),
            decision_us=decision_time(player) * 1e6,
        )


def decision_time(player: Contestant) -> float:
    """Median time [s] of one decision of `player` at one table of match-v0."""
    from baselines import make_player

    tables = Tables("match-v0", 1)
    seat = Seat.from_tables(tables)
    made: Player = make_player(player, seat) if isinstance(player, str) else player(seat)
    made.reset(np.ones(1, np.bool_))
    spent = np.zeros(TIMED_DECISIONS)
    for number in range(TIMED_DECISIONS):
        begun = time.perf_counter()
        made.act(tables.observations[:, 0])
        spent[number] = time.perf_counter() - begun
    return float(np.median(spent))


def measure_robustness(first: Contestant, opponent: str, games: int, seed: int) -> Robustness:
    """Win rates of `first` against `opponent` over camera delays and over camera noise; both see through the camera."""

    def rates(name: str, values: Sequence[float]) -> tuple[tuple[float, IntervalEstimate], ...]:
        found = []
        for value in values:
            result = play(_through_camera(**{name: value}), first, opponent, games, seed)
            found.append((value, paired_win_rate(result.padded_results)))
        return tuple(found)

    return Robustness(opponent, rates("camera_latency", DELAYS), rates("camera_noise", NOISES))


def _through_camera(**parameters: float) -> Variant:
    """match-v0 observed through a camera whose only errors are those in `parameters`."""
    match = find_variant("match-v0")
    clear = {**match.parameters, **dict.fromkeys(CAMERA_ERRORS, 0.0)}
    return replace(match, sensing=ESTIMATED, parameters={**clear, **parameters})
