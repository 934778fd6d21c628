"""One diagnosis held against its key: what of it is right, and by how much its numbers are off."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from math import hypot
from typing import Any

SILENT = ("nothing", "parameters")  # kinds of cases in which nothing is missing
# Numbers that are components of one: the error of each is measured by the size of all.
VECTORS = (
    ("tilt_x", "tilt_y"),
    ("warp_xx", "warp_yy", "warp_xy"),
    ("scale_x", "scale_y", "shear"),
    ("grain", "turning"),
)
PLACES = ("walls", "stream")  # where a law may be that is nothing elsewhere
OTHER_NAMES = {"e_slope": "slope"}


@dataclass(frozen=True)
class Number:
    """A fitted number beside the true one; `error` is relative."""

    mechanism: str
    name: str
    truth: float
    value: float
    error: float
    covered: bool


@dataclass(frozen=True)
class Score:
    """What is right in one answer. Where a question does not arise, the answer to it is None."""

    label: str
    kind: str
    scenario: str
    truth: tuple[str, ...]
    law: str | None  # of an unlisted one
    said: tuple[str, ...]
    verdict: str  # the diagnosis's; "failed" where there is none
    seconds: float
    error: str | None
    named: bool = False  # the names are the true ones, all of them and no other
    located: bool | None = None  # the regimes are
    within: bool | None = None  # every true name is among winners and also_possible
    set_size: float | None = None  # of these, for each true name
    false_alarm: bool | None = None
    depends_right: bool | None = None
    excess_removed: float | None = None  # (before - after) / (before - floor), rms
    numbers: tuple[Number, ...] = field(default_factory=tuple)

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data."""
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
    if kind in SILENT:
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
    """How much of the held-out error above the floor has gone; None where there was none to remove."""
    if not heldout:
        return None
    before, after, floor = (heldout.get(name) for name in ("before_m", "after_m", "floor_m"))
    if before is None or after is None or floor is None or before <= floor:
        return None
    return (before - after) / (before - floor)


def compare(finding: dict[str, Any], key: dict[str, Any]) -> list[Number]:
    """The numbers of a rightly named finding that the key knows, beside the true ones: 0 at another wall or clock."""
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
    """Whether a finding is about the wall or the stream that the key is about."""
    return all(said[name] == truth[name] for name in PLACES if name in said and name in truth)
