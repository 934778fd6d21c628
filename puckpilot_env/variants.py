"""What a variant is, and which there are: every module `NAME_vN.py` of this package that holds a `VARIANT`.

Adding a variant is adding such a file; the registries, the commands, the pages and the tests find it there.
"""

from __future__ import annotations

import difflib
import importlib
import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from puckpilot_env.game import sensing
from puckpilot_env.game.rules import RULES
from puckpilot_env.options.inputs import in_short
from puckpilot_env.options.randomization import Draw, as_rows

# What changed in place before anything was released.
FOULS = "v0, before the first release: a puck held for 7 s is a foul and the opponent serves; it was faced off"
TOUCHES = "v0, before the first release: possession is lost, and a clear is made, by who touched the puck alone"
NOMINAL = "v0, before the first release: where the puck is expected follows the nominal parameters, not the drawn ones"


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
    period: float = 0.1  # of a step [s]
    step_limit: int = 0  # truncation; 0 for none
    sparse_reward: bool = False  # whether nothing but goals, or who won a drill, is rewarded
    points: int = 7  # to win a match
    match_time: float = 180.0  # s
    possession_time: float = 7.0  # longest in one half of a match [s]
    parameters: dict[str, float] = field(default_factory=dict)  # other than the defaults
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
        for name in RULES.names or ():
            record[name] = getattr(self, name)
        return record

    def drawn(self) -> np.ndarray:
        """Its randomization as `(draws, 4)` rows; see `randomization.as_rows`."""
        return as_rows(self.draws)


@cache
def all_variants() -> dict[str, Variant]:
    """Every variant by its id, in the order of their names."""
    files = sorted(p.stem for p in Path(__file__).parent.glob("*_v*.py") if re.fullmatch(r"[a-z_]+_v\d+", p.stem))
    found = [importlib.import_module(f"puckpilot_env.{stem}").VARIANT for stem in files]
    return {variant.id: variant for variant in found}


def find_variant(name: str) -> Variant:
    """The variant of an id, with or without `puckpilot/`. Raises ValueError, in one line, for an unknown one."""
    if not isinstance(name, str):
        raise ValueError(f"variant is {in_short(name)}; expected an id such as 'match-v0', or a Variant")
    known = all_variants()
    full = name if name.startswith("puckpilot/") else f"puckpilot/{name}"
    if full not in known:
        near = difflib.get_close_matches(full, known, n=1, cutoff=0.85)
        hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(known)}"
        raise ValueError(f"unknown variant '{name}'; {hint}")
    return known[full]
