"""Convert the formula of an unlisted law to parameters of the simulator's `unlisted_drive`, to simulate it."""

from __future__ import annotations

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import unlisted_drive
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.regimes.gantry.formula import GantryProjection
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_LAW

# By the first word of a law's name and the symbol of the formula's coordinate: the `kind` of the effect
EFFECT_KINDS = {
    ("force", "p"): unlisted_drive.FORCE_BY_PLACE,
    ("loss", "p"): unlisted_drive.LOSS_BY_PLACE,
    ("loss", "speed"): unlisted_drive.LOSS_BY_SPEED,
    ("pull", "volts"): unlisted_drive.PULL_BY_VOLTS,
    ("pull", "volts_of_both"): unlisted_drive.PULL_BY_LOAD,
    ("loss", "t"): unlisted_drive.LOSS_BY_TIME,
    ("pull", "t"): unlisted_drive.PULL_BY_TIME,
    ("loss", "heading"): unlisted_drive.LOSS_BY_HEADING,
}


def effect_parameters(law: Law, found: SearchResult, formula: Formula, view: GantryProjection) -> dict[str, float]:
    """The simulator's parameters by name: the formula's extra volts, and the law's other parameters beside them."""
    volts = formula.form.field(formula.values)[:, 0]
    acts = [bool(part.any()) for part in np.split(volts, 2)]
    here = np.abs(view.driver) > GANTRY_LAW.least_driver * np.sqrt(np.mean(view.driver**2))
    here &= np.repeat(acts, len(volts) // 2)
    at, where = np.unique(view.coordinate[here], return_index=True)
    knots = np.linspace(at[0], at[-1], unlisted_drive.NUMBERS)
    numbers = np.interp(knots, at, (volts[here] / view.driver[here])[where])
    kind = EFFECT_KINDS[law.name.split()[0], view.symbol]
    axes = unlisted_drive.ON_X * acts[0] + unlisted_drive.ON_Y * acts[1]
    table = dict(zip(unlisted_drive.EFFECT.row_names, (kind, axes, at[0], at[-1], *numbers), strict=True))
    moved = {
        name: found.final.values[name] + float(by) for name, by in zip(found.final.free, formula.moved, strict=True)
    }
    return {name: BY_NAME[name].within(float(value)) for name, value in {**moved, **table}.items()}
