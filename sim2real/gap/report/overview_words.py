"""What several circles say together, as lines for a terminal."""

from __future__ import annotations

from typing import Any

from sim2real.gap.arms import ARMS, OWN

COLUMN = 26  # characters of an arm's column


def overview_lines(result: dict[str, Any]) -> list[str]:
    """A line for each table of an `overview`: net goals a minute, and what each arm won back; and how often the arm OWN
    is better than each other."""
    arms = [arm for arm in ARMS if any(arm in one["arms"] for one in result["tables"].values())]
    lines = [
        "net goals a minute, and won back, with 95 % intervals",
        f"{'table':12}{'simulator':>10}{'table':>8}" + "".join(f"{arm:>{COLUMN}}" for arm in arms),
    ]
    for name, one in result["tables"].items():
        changes = "".join(f"{_change(one['arms'].get(arm)):>{COLUMN}}" for arm in arms)
        lines.append(f"{name:12}{one['simulator']:10.2f}{one['before']:8.2f}{changes}")
    for arm, count in result["own_better_on"].items():
        lines.append(
            f"{OWN} wins back more than {arm} on {count['better']} of {count['tables']} tables, "
            f"on {count['clearly']} beyond the interval"
        )
    return lines


def _change(arm: dict[str, Any] | None) -> str:
    if arm is None:
        return ""
    change = arm["change"]
    return f"{change['value']:+.2f} ({change['low']:.2f} to {change['high']:.2f})"
