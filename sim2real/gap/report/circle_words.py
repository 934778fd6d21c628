"""What a circle comes to, as lines for a terminal."""

from __future__ import annotations

from typing import Any

from sim2real.gap.report.found_words import against_line, found_words

WIDE = 24  # characters of the column that says who plays


def circle_lines(result: dict[str, Any]) -> list[str]:
    """What was found, and a line for each player: goals a minute, and what it won back."""
    simulated, before = result["simulator"], result["before"]
    lines = [f"the diagnosis of its play: {found_words(result)}"]
    header = (
        f"{'goals a minute':{WIDE}} {'for':>5} {'against':>8} {'net':>6}  {'95 %':>14}  {'won back':>8}  {'95 %':>14}"
    )
    if result["against_truth"] is None:
        lines.append(header)
    else:
        lines += [
            f"beside the truth: {against_line(result['against_truth'])}",
            header,
            f"{'in the simulator':{WIDE}} {simulated['scored']:5.2f} {simulated['conceded']:8.2f} "
            f"{simulated['scored'] - simulated['conceded']:6.2f}",
        ]
    lines.append(f"{'on the table, as it is':{WIDE}} {_rates(before)}")
    for name, arm in result["arms"].items():
        more = arm["change"]
        lines.append(f"{name:{WIDE}} {_rates(arm)}  {more['value']:+8.2f}  {more['low']:+6.2f} {more['high']:+7.2f}")
    return lines


def _rates(one: dict[str, Any]) -> str:
    net = one["net"]
    return (
        f"{one['scored']['value']:5.2f} {one['conceded']['value']:8.2f} {net['value']:6.2f}  "
        f"{net['low']:6.2f} {net['high']:7.2f}"
    )
