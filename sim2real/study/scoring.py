"""Score one diagnosis against its key: correct answers, and errors of parameters."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from math import hypot
from typing import Any

NOTHING_MISSING = ("nothing", "parameters")  # kinds of cases without a missing effect
# Components of a vector: the error of each is relative to the vector's length.
VECTORS = (
    ("tilt_x", "tilt_y"),
    ("warp_xx", "warp_yy", "warp_xy"),
    ("scale_x", "scale_y", "shear"),
    ("grain", "turning"),
    ("x0", "x1", "y0", "y1", "angle"),
)
PLACES = ("walls", "stream")  # keys of the place of a law that is zero elsewhere
OTHER_NAMES = {"e_slope": "slope"}


@dataclass(frozen=True)
class Number:
    """A fitted and a true parameter; `error` is relative."""

    mechanism: str
    name: str
    truth: float
    value: float
    error: float
    covered: bool


@dataclass(frozen=True)
class Score:
    """The score of one answer; None for questions that do not apply."""

    label: str
    kind: str
    scenario: str
    truth: tuple[str, ...]
    law: str | None  # name of an unlisted law
    said: tuple[str, ...]
    verdict: str  # of the diagnosis; "failed" if there is none
    seconds: float
    error: str | None
    named: bool = False  # the findings are exactly the true effects
    located: bool | None = None  # the regimes of the findings are exactly the true ones
    within: bool | None = None  # every true effect is among findings and also_possible
    set_size: float | None = None  # size of that set for each true effect
    false_alarm: bool | None = None
    depends_right: bool | None = None
    excess_removed: float | None = None  # (before - after) / (before - floor), rms
    numbers: tuple[Number, ...] = field(default_factory=tuple)

    def as_dict(self) -> dict[str, Any]:
        """The score as plain data."""
        return asdict(self)


def score(label: str, key: dict[str, Any], answer: dict[str, Any]) -> Score:
    """Score an answer of `diagnosing.diagnose_cases` by its key."""
    truth, kind = tuple(key["mechanisms"]), key["kind"]
    diagnosis = answer.get("diagnosis") or {}
    findings = diagnosis.get("findings") or []
    said = tuple(finding["mechanism"] for finding in findings)
    verdict = diagnosis.get("verdict", "failed")
    names_right = bool(diagnosis) and set(said) == set(truth)
    common = {
        "label": label, "kind": kind, "scenario": key["scenario"], "truth": truth, "law": key.get("law"), "said": said,
        "verdict": verdict, "seconds": answer.get("seconds", 0.0), "error": answer.get("error"),
    }  # fmt: skip
    if kind in NOTHING_MISSING:
        quiet = names_right and verdict in ("agrees", "parameters_only")
        return Score(**common, named=quiet, false_alarm=bool(said) if diagnosis else None)
    possible = set(said).union(*(finding.get("also_possible", ()) for finding in findings))
    depends = None
    if kind == "unlisted":
        depends = any(
            set(finding.get("depends_on", ())) == set(key["depends"])
            for finding in findings
            if finding["mechanism"] == "unlisted"
        )
    return Score(
        **common,
        named=names_right,
        located={finding["regime"] for finding in findings} == set(key["regimes"]),
        within=set(truth) <= possible,
        set_size=len(possible) / len(truth) if possible else None,
        depends_right=depends,
        excess_removed=excess_removed(diagnosis.get("heldout")),
        numbers=tuple(number for finding in findings for number in compare(finding, key)),
    )


def excess_removed(heldout: dict[str, Any] | None) -> float | None:
    """The share of the holdout error above the floor that was removed; None if there was none to remove."""
    if not heldout:
        return None
    before, after, floor = (heldout.get(name) for name in ("before_m", "after_m", "floor_m"))
    if before is None or after is None or floor is None or before <= floor:
        return None
    return (before - after) / (before - floor)


def compare(finding: dict[str, Any], key: dict[str, Any]) -> list[Number]:
    """The parameters of a correctly named finding with their true values, which are 0 at another wall or clock."""
    truths: dict[str, float] = key["values"].get(finding["mechanism"], {})
    there = _there(finding.get("where", {}), key.get("where", {}).get(finding["mechanism"], {}))
    numbers = []
    parameters: dict[str, Any] = finding.get("parameters", {})
    for given, estimate in parameters.items():
        name = OTHER_NAMES.get(given, given)
        if name not in truths:
            continue
        truth, value = truths[name] if there else 0.0, estimate["value"]
        group = next((group for group in VECTORS if name in group), (name,))
        size = hypot(*(truths[one] for one in group))
        covered = estimate["low"] <= truth <= estimate["high"]
        numbers.append(Number(finding["mechanism"], name, truth, value, abs(value - truth) / size, covered))
    return numbers


def _there(said: dict[str, Any], truth: dict[str, Any]) -> bool:
    """Whether a finding is at the same wall or stream as the key."""
    return all(said[name] == truth[name] for name in PLACES if name in said and name in truth)
