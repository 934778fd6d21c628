"""Whether a player could play on a real gantry: what the Robot Air Hockey Challenge weighs beside goals, for this one.

The challenge (Liu et al., "A Retrospective on the Robot Air Hockey Challenge", NeurIPS datasets and benchmarks 2024)
counts violations of the table's edge, of joints and motors, jerky commands, and slow decisions. Here plans keep the
voltage and the area by construction, so what is measured is how much of them a player uses, and how near it comes.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from agents.gantry_load import peak_accelerations
from baselines.intervals import Estimate, paired_win_rate
from baselines.match import Contestant, play
from baselines.player import Player, Seat
from puckpilot_env.game.sensing import ESTIMATED
from puckpilot_env.tables import Tables
from puckpilot_env.variants import Variant, find_variant

DELAYS = (0.0, 0.02, 0.04, 0.06)  # s, from exposure to a usable position
NOISES = (0.0, 0.0005, 0.001, 0.002)  # m, white, of each measured position
FAULTS = (  # of a camera
    "camera_latency", "camera_noise", "beam_noise", "beam_width", "camera_error", "dropped_frames", "held_frames",
)  # fmt: skip
TIMED = 2000  # decisions


@dataclass(frozen=True)
class Deployability:
    """How a player treats the gantry, over all decisions of some games, and how long it thinks.

    - `wall_margin_m`: 1st percentile of the way from the mallet's rim to the nearest wall of its own half.
    - `voltage_share`, `voltage_most`: mean and greatest share of the most voltage that it may ask for.
    - `acceleration_m_s2`: 99th percentile over decisions of the greatest acceleration until the next one.
    - `jitter_m`: mean change of the commanded place between decisions.
    - `decision_us`: median time of one decision at one table.
    """

    wall_margin_m: float
    voltage_share: float
    voltage_most: float
    acceleration_m_s2: float
    jitter_m: float
    decision_us: float

    def as_dict(self) -> dict[str, float]:
        return asdict(self)


@dataclass(frozen=True)
class Robustness:
    """Share of decisive games won when the table is seen through a camera: `delays` [s] late, and with `noises` [m]."""

    opponent: str
    delays: tuple[tuple[float, Estimate], ...]
    noises: tuple[tuple[float, Estimate], ...]

    def as_dict(self) -> dict[str, object]:
        return {
            "opponent": self.opponent,
            "delay_s": [{"at": at, **rate.as_dict()} for at, rate in self.delays],
            "noise_m": [{"at": at, **rate.as_dict()} for at, rate in self.noises],
        }


def measure_deployability(first: Contestant, opponent: Contestant, games: int, seed: int) -> Deployability:
    """Watch `first` in match-v0 against `opponent`, and time its decisions."""
    watched = _Watched()
    play("match-v0", first, opponent, max(games, 1), seed, watch=watched.see)
    return watched.summary(first)


class _Watched:
    """What is noted of player 0 at each step of the games that are not over."""

    def __init__(self) -> None:
        self.actions: list[NDArray[np.float32]] = []
        self.places: list[NDArray[np.float32]] = []
        self.peaks: list[NDArray[np.float64]] = []
        self.running: list[NDArray[np.bool_]] = []
        self.tables: Tables | None = None

    def see(self, tables: Tables, actions: NDArray[np.float32]) -> None:
        before = self.running[-1] if self.running else np.ones(len(tables), np.bool_)
        self.running.append(before & ~(tables.terminated | tables.truncated))
        self.tables = tables
        self.actions.append(actions[:, 0].copy())
        self.places.append(tables.observations[:, 0, :2].copy())  # of the mallet
        self.peaks.append(peak_accelerations(tables, actions))

    def summary(self, player: Contestant) -> Deployability:
        assert self.tables is not None  # a game has at least one step
        actions, places, running = np.stack(self.actions), np.stack(self.places), np.stack(self.running)
        p = self.tables.nominal[0]
        x, y = places[..., 0], places[..., 1]
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
    """Median time [s] of one decision at one table."""
    from baselines import make_player

    tables = Tables("match-v0", 1)
    seat = Seat.from_tables(tables)
    made: Player = make_player(player, seat) if isinstance(player, str) else player(seat)
    made.reset(np.ones(1, np.bool_))
    spent = np.zeros(TIMED)
    for number in range(TIMED):
        begun = time.perf_counter()
        made.act(tables.observations[:, 0])
        spent[number] = time.perf_counter() - begun
    return float(np.median(spent))


def measure_robustness(first: Contestant, opponent: str, games: int, seed: int) -> Robustness:
    """Win rates against `opponent`, who is as hampered, over camera delays and over noise."""

    def rates(name: str, values: Sequence[float]) -> tuple[tuple[float, Estimate], ...]:
        found = []
        for value in values:
            result = play(_seen_by_camera(**{name: value}), first, opponent, games, seed)
            found.append((value, paired_win_rate(result.padded_results)))
        return tuple(found)

    return Robustness(opponent, rates("camera_latency", DELAYS), rates("camera_noise", NOISES))


def _seen_by_camera(**parameters: float) -> Variant:
    """match-v0 seen through a camera without other faults: no noise, smooth error, dropped or held frames."""
    match = find_variant("match-v0")
    clear = {**match.parameters, **dict.fromkeys(FAULTS, 0.0)}
    return replace(match, sensing=ESTIMATED, parameters={**clear, **parameters})
