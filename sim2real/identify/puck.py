"""Identify the puck's constants: the baseline's laws of glide, walls and mallet, refitted as a diagnosis does it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from puckpilot_env.options.profile_file import FittedLaw, Profile, Value
from puckpilot_env.options.randomization import Draw
from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.identify import Identification, identify
from sim2real.diagnose.input_checks import UndeterminedError, check_usable
from sim2real.diagnose.prove import prove
from sim2real.diagnose.regimes.base import IdentifiedRegime
from sim2real.diagnose.split import split_data
from sim2real.identify.tuned import GANTRY
from sim2real.recording.folder import Recording
from sim2real.recording.stated import together
from sim2real.recording.table_parameters import parameters, stated_sizes

REGIMES = ("glide", "wall", "mallet")
LAW = "baseline"
WORDS = "m s'' = -f - B s'^2; one restitution of walls, one of the mallet"


def identify_puck(
    recordings: Sequence[Recording], heldout: Sequence[Recording], progress: Callable[[str, float], None]
) -> tuple[Profile, tuple[str, ...]]:
    """The profile of the puck of `recordings`, and what is not in it and why, a sentence each.

    The rms are those of glides and bounces held out: of the recordings `heldout` or, without them, of about every sixth
    launch. `progress` is called with a stage and the share done. Raises ValueError, in one line, for recordings that
    cannot be used.
    """
    stated = together(recordings, {})
    held_out = together([*stated, *heldout], {})[len(recordings) :]
    try:
        check_usable(stated)
        split = split_data([one.from_zero() for one in stated], [one.from_zero() for one in held_out])
        values = parameters(split.training[0])
        found = identify(split.training, _without_paths(split.training), values, progress)
    except UndeterminedError as why:
        raise ValueError(f"{why.reason}; {why.remedy}") from None
    proofs = prove(found, split.holdout, _without_paths(split.holdout), values)
    rms = {one.regime: (one.proof.before_m,) for one in proofs if one.proof and one.regime in REGIMES}
    names = tuple(one.name for one in recordings), tuple(one.name for one in heldout)
    return _profile(found, stated_sizes(stated[0]), rms, *names)


def _without_paths(recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings without the mallet's path, for the gantry, which is not identified here."""
    return [replace(one, mallet=None) for one in recordings]


def _profile(found: Identification, sizes, rms, names: tuple[str, ...], held: tuple[str, ...]):
    numbers: dict[str, Value] = {}
    launches, missing = 0, []
    for regime in REGIMES:
        one = found.regimes.get(regime)
        if one is None or one.final is None:
            reason = one.regime_result.undetermined if one else "nothing of it was recorded"
            missing.append(f"{regime}: not determined, {reason}")
            continue
        numbers |= {name: _value(one, name) for name in one.final.baseline.free}
        launches += len(one.final.clusters) if regime == REGIMES[0] else 0
        if one.regime_result.findings:
            names_of = " and ".join(each.mechanism for each in one.regime_result.findings)
            missing.append(f"{regime}: these constants stand in for {names_of}; puckpilot diagnose tells the law")
    if not numbers:
        raise ValueError(f"nothing of the puck can be determined ({'; '.join(missing)}); record more launches")
    known = {name: one.value for name, one in numbers.items() if one.determined}
    source = f"95 % interval, fitted to {' and '.join(names)}"
    draws = tuple(Draw(name, "uniform", *_range(name, numbers[name]), source) for name in known)
    fitting = {name: value for name, value in sizes.items() if BY_NAME[name].within(value) == value}
    law = FittedLaw(WORDS, numbers, rms)
    windows = {"launches": float(launches)}
    return Profile("puck", names, held, LAW, (), windows, {**fitting, **known}, draws, {LAW: law}), tuple(missing)


def _value(one: IdentifiedRegime, name: str) -> Value:
    """A refitted constant; determined unless its interval is wide, or it ended at a bound."""
    assert one.final is not None
    found, at_bound = one.final.baseline.estimate(name), name in one.final.baseline.bound
    wide = found.high - found.low > 2.0 * GANTRY.widest * abs(found.value)
    return Value(found.value, found.low, found.high, found.unit, not (wide or at_bound))


def _range(name: str, value: Value) -> tuple[float, float]:
    return BY_NAME[name].within(value.low), BY_NAME[name].within(value.high)
