"""The registered variants. A variant is data: game, sensing, parameters, what is drawn; adding one is adding a row."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from puckpilot_env import parameters
from puckpilot_env.game import sensing, start
from puckpilot_env.game.rules import RULES

UNIFORM, LOG_UNIFORM = "uniform", "log-uniform"


@dataclass(frozen=True)
class Draw:
    """A parameter that every table draws anew for each episode, and why in this range."""

    parameter: str
    distribution: str
    low: float
    high: float
    source: str


@dataclass(frozen=True)
class Variant:
    """Everything that makes an id."""

    name: str  # without version
    version: int
    summary: str  # one sentence; the page begins with it
    game: int  # start.DEFENCE, ATTACK or MATCH
    ending: str  # in words, for the page
    sensing: int = sensing.EXACT
    shows_gantry: bool = False
    period: float = 0.1
    step_limit: int = 0
    points: int = 7
    match_time: float = 180.0
    possession_time: float = 7.0
    parameters: dict[str, float] = field(default_factory=dict)
    draws: tuple[Draw, ...] = ()
    history: tuple[str, ...] = ("v0: first version",)

    @property
    def module(self) -> str:
        """Name of its module in puckpilot_env, as in `from puckpilot_env import match_v0`."""
        return f"{self.name.replace('-', '_')}_v{self.version}"

    @property
    def id(self) -> str:
        """Its id in the registries of PettingZoo and Gymnasium."""
        return f"puckpilot/{self.name}-v{self.version}"

    def rules(self) -> np.ndarray:
        """A `(1,)` record of `rules.RULES`."""
        record = np.zeros(1, RULES)
        for name in (
            "game",
            "sensing",
            "shows_gantry",
            "period",
            "points",
            "match_time",
            "possession_time",
            "step_limit",
        ):
            record[name] = getattr(self, name)
        return record

    def drawn(self) -> np.ndarray:
        """`(draws, 4)` float64: column of the parameter, kind of distribution, low, high."""
        kinds = {UNIFORM: start.UNIFORM, LOG_UNIFORM: start.LOG_UNIFORM}
        rows = [(parameters.COLUMN[d.parameter], kinds[d.distribution], d.low, d.high) for d in self.draws]
        return np.array(rows, np.float64).reshape(len(rows), 4)


REALITY: tuple[Draw, ...] = (
    Draw("friction", LOG_UNIFORM, 0.06, 0.25, "report F.2 (0.125), halved and doubled"),
    Draw("drag", LOG_UNIFORM, 0.014, 0.25, "from a ninth of the report's, as fitted on a real table, to its double"),
    Draw("wall_restitution", UNIFORM, 0.65, 0.9, "report F.3 (0.7) and a real table (0.83 to 0.86)"),
    Draw("mallet_restitution", UNIFORM, 0.5, 0.9, "not measured; a wide choice"),
    Draw("gantry_spread", UNIFORM, 0.0, 0.1, "spread of gantry fits between voltages; a choice"),
    Draw("camera_noise", UNIFORM, 0.00015, 0.0003, "0.2 mm measured on the real table"),
    Draw("beam_noise", UNIFORM, 0.0004, 0.0008, "0.6 mm measured on the real table near the beam"),
    Draw("camera_error", UNIFORM, 0.0005, 0.0015, "about 1 mm, report 2.2.2"),
    Draw("dropped_frames", UNIFORM, 0.0, 0.03, "recordings of the real table"),
    Draw("held_frames", UNIFORM, 0.0, 0.05, "recordings of the real table"),
    Draw("action_noise", UNIFORM, 0.0, 0.05, "supply under load; a choice"),
    Draw("impulse_rate", UNIFORM, 0.0, 0.2, "report K.2 names them without a number"),
)

_DEFENCE = Variant(
    "defence", 0, "A shot comes from the other half; player_0 has to keep it out and take control.",
    start.DEFENCE,
    "The drill ends when player_0 clears the puck, concedes, or sends it back over the middle line, or after 10 s.",
    step_limit=100,
)  # fmt: skip
_ATTACK = Variant(
    "attack", 0, "The puck is under player_0's control; it has to shoot past player_1.",
    start.ATTACK,
    "The drill ends when the puck crosses the middle line or enters player_0's own goal, or after 10 s.",
    step_limit=100,
)  # fmt: skip
_MATCH = Variant(
    "match", 0, "A whole match: first to 7, three minutes, face-offs, and a rule against holding the puck.",
    start.MATCH,
    "First to 7 points, or the leader after 180 s (a draw if level). After a goal the conceder serves; a puck that stays "
    "7 s in one half is faced off on the middle line.",
)  # fmt: skip


def _randomized(variant: Variant) -> Variant:
    return replace(
        variant,
        name=f"{variant.name}-randomized",
        summary=f"{variant.summary} Every table differs, and is seen late and noisily through a camera.",
        sensing=sensing.ESTIMATED,
        shows_gantry=True,
        draws=REALITY,
    )


VARIANTS: tuple[Variant, ...] = (
    _DEFENCE,
    _ATTACK,
    _MATCH,
    _randomized(_DEFENCE),
    _randomized(_ATTACK),
    _randomized(_MATCH),
    replace(
        _MATCH,
        name="match-sensors",
        summary=f"{_MATCH.summary} The agent sees delayed position measurements instead of velocities.",
        sensing=sensing.HISTORY,
    ),
)
BY_ID: dict[str, Variant] = {variant.id: variant for variant in VARIANTS}
