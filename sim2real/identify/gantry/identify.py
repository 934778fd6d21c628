"""Identify a gantry from its logs: choose a law, fit it, and say how well laws predict logs that were not fitted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.options.profile_file import FittedLaw, Profile, Value
from puckpilot_env.options.randomization import Draw
from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.output.draws_toml import SPREAD, playable_spread
from sim2real.identify.gantry.choose import Tried, choose
from sim2real.identify.gantry.fit import Fit, fit, rms
from sim2real.identify.gantry.law import NUMBERS, THIRD_ORDER
from sim2real.identify.gantry.logs import Piece, parts, read_log, whole
from sim2real.identify.tuned import GANTRY
from sim2real.recording.folder import Recording
from sim2real.recording.stated import together
from sim2real.recording.table_parameters import parameters

CHOOSING = 0.9  # of the progress bar
BASELINE = "third_order"


@dataclass(frozen=True)
class IdentifiedGantry:
    """What was found: the `laws` that were tried, the third-order law and the chosen one as fitted to all recordings.

    `rms`: of each law by its last step, for each piece that was not fitted the rms (h,) [m] at `GANTRY.judged`;
    `sizes`: pulley radius [m] and supply [V], by the simulator's names.
    """

    laws: Sequence[Tried]
    third_order: Fit
    chosen: Fit
    pieces: Sequence[Piece]
    holdout: Sequence[Piece]
    rms: Mapping[str, Mapping[str, np.ndarray]]
    sizes: Mapping[str, float]

    @property
    def chosen_name(self) -> str:
        """The last step of the chosen law."""
        return self.chosen.law.steps[-1] if self.chosen.law.steps else BASELINE

    @property
    def windows(self) -> int:
        """Number of fitted windows."""
        return sum(len(one.fit.start) for one in self.pieces)


def identify_gantry(
    recordings: Sequence[Recording], heldout: Sequence[Recording], progress: Callable[[str, float], None]
) -> IdentifiedGantry:
    """Identify the gantry of `recordings`; `progress` is called with a stage and the share done.

    Each law is judged on the recordings `heldout`; without them on each recording by the fit to the others, and with
    one recording alone on parts of it in time. The law is chosen without those held out. Raises ValueError, in one
    line, for recordings that cannot be used or are of different tables.
    """
    stated = together([*recordings, *heldout], {})
    values = parameters(stated[0])
    sizes = {name: values[name] for name in ("pulley_radius", "max_voltage")}
    logs = [whole(read_log(one, sizes["max_voltage"])) for one in stated]
    pieces, held = logs[: len(recordings)], logs[len(recordings) :]
    pieces = parts(pieces[0]) if len(pieces) == 1 else pieces
    laws = choose(pieces, sizes["pulley_radius"], lambda words, share: progress(words, CHOOSING * share))
    progress("intervals", CHOOSING)
    third, chosen = laws[1].law, [one for one in laws if one.kept][-1].law
    rms_of = _rms(laws, pieces, held)
    return IdentifiedGantry(laws, fit(third, pieces), fit(chosen, pieces), pieces, held, rms_of, sizes)


def _rms(laws: Sequence[Tried], pieces: Sequence[Piece], held: Sequence[Piece]):
    if held:
        return {one.step: {piece.name: rms(one.law, piece) for piece in held} for one in laws}
    return {one.step: {piece.name: found for piece, found in zip(pieces, one.rms, strict=True)} for one in laws}


def profile_of(found: IdentifiedGantry) -> Profile:
    """The profile: constants of third order for the simulator and the board, and both laws with their intervals."""
    values = {**found.third_order.law.parameters(), **found.sizes}
    names = [one.log.name for one in found.pieces]
    laws = {
        BASELINE: _fitted_law(found.third_order, found.rms[BASELINE]),
        found.chosen_name: _fitted_law(found.chosen, found.rms[found.chosen_name]),
    }
    windows = {"past": GANTRY.past, "ahead": max(GANTRY.fitted), "every": GANTRY.fit_every, "count": found.windows}
    return Profile(
        "gantry", tuple(dict.fromkeys(names)), tuple(one.name for one in found.holdout), found.chosen_name,
        GANTRY.judged, windows, {name: BY_NAME[name].within(value) for name, value in values.items()},
        _draws(found, values), laws,
    )  # fmt: skip


def _fitted_law(one: Fit, scores: Mapping[str, np.ndarray]) -> FittedLaw:
    values = {}
    for name in one.law.free:
        interval = one.interval(name)
        values[name] = Value(interval.value, interval.low, interval.high, NUMBERS[name].unit, interval.determined)
    return FittedLaw(one.law.words, values, {name: tuple(found.tolist()) for name, found in scores.items()})


def _draws(found: IdentifiedGantry, values: Mapping[str, float]) -> tuple[Draw, ...]:
    """The coefficients themselves cannot be drawn, as players see their own gantry's shares of the nominal ones."""
    third = found.third_order
    share = max(third.half({name: 1.0}) / third.law.values[name] for name in THIRD_ORDER)
    spread = playable_spread(share, values)
    source = f"widest of the 95 % intervals of C6 and C7, fitted to {len(found.pieces)} logs of the gantry"
    return (Draw(SPREAD, "uniform", 0.0, spread, source),) if spread > 0.0 else ()
