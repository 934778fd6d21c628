"""What a diagnosis found, beside the truth, and what was learnt from it, in words for the page and the terminal."""

from __future__ import annotations

from typing import Any

SILENT = {
    "agrees": "Nothing: the simulator explains that play as it is.",
    "parameters_only": "Nothing: the simulator's laws explain that play, with other constants.",
    "undetermined": "It cannot tell: that play does not settle whether physics is missing.",
}


def found_words(result: dict[str, Any]) -> str:
    """What was named, or that nothing was and how the diagnosis put that; and what it leaves open."""
    named = f"{', '.join(result['found'])}." if result["found"] else SILENT[result["verdict"]]
    left_open = "; ".join(f"{regime}: {reason}" for regime, reason in result["open"].items())
    return f"{named} Undetermined: {left_open}." if left_open else named


def learnt_words(learnt: dict[str, Any]) -> str:
    """What the arm `corrected` learns on, in a few sentences."""
    constants = ", ".join(f"{name} {value:.4g}" for name, value in learnt["constants"].items())
    draws = ", ".join(f"{name} {low:.4g} to {high:.4g}" for name, (low, high) in learnt["draws"].items())
    parts = [
        f"effects switched on: {', '.join(learnt['effects']) or 'none'}",
        f"refitted constants in place of the simulator's: {constants or 'none'}",
        f"drawn from their intervals: {draws or 'nothing'}",
    ]
    return f"The arm corrected learns, or would learn, on what follows from it; {'; '.join(parts)}."


def against_rows(against_truth: list[dict[str, Any]]) -> list[list[str]]:
    """A row for each number of each effect: effect, outcome, number, found, its 95 % interval, truth."""
    rows = []
    for one in against_truth:
        first = [one["effect"], one["outcome"]]
        if not one["numbers"]:
            rows.append([*first, "", "", "", ""])
        for short, number in one["numbers"].items():
            found, unit = number["found"], "" if number["unit"] == "1" else f" [{number['unit']}]"
            values = [f"{found['value']:.4g}", f"{found['low']:.4g} to {found['high']:.4g}"] if found else ["", ""]
            rows.append([*first, f"{short}{unit}", *values, f"{number['truth']:.4g}"])
            first = ["", ""]
    return rows


def against_line(against_truth: list[dict[str, Any]]) -> str:
    """All outcomes in a line: each with its effects."""
    outcomes: dict[str, list[str]] = {}
    for one in against_truth:
        outcomes.setdefault(one["outcome"], []).append(one["effect"])
    return "; ".join(f"{outcome}: {', '.join(names)}" for outcome, names in outcomes.items()) or "nothing is concealed"
