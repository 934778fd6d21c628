"""The held-out proof as a small picture of bars."""

from __future__ import annotations

from sim2real.diagnose.finding import Proof
from sim2real.diagnose.report.words import number, text

ROW, LEFT, WIDTH = 24, 266, 700
ROOM = 110  # for the numbers beside the bars
NOISE = "what noise alone leaves"


LAWS = ("refitted baseline", "with the law")
FAULTS = ("as recorded", "corrected")


def proof_bars(proof: Proof, title: str, found: bool, names: tuple[str, str] = LAWS) -> str:
    """Bars of the rms [mm] on held-out pieces, before and, if something was `found`, after, by these `names`; and what
    noise alone leaves."""
    rows = [(names[0], proof.before_m, "#D55E00"), (names[1], proof.after_m, "#0072B2"),
            (NOISE, proof.floor_m, "#767676")]  # fmt: skip
    if not found:
        del rows[1]
    longest = max(size for _, size, _ in rows) or 1.0
    words = ", ".join(f"{name} {number(1e3 * size)} mm" for name, size, _ in rows)
    parts = []
    for k, (name, size, colour) in enumerate(rows):
        long = (WIDTH - LEFT - ROOM) * size / longest
        middle = k * ROW + 16
        parts.append(
            f'<text x="{LEFT - 8}" y="{middle}" text-anchor="end">{text(name)}</text>'
            f'<rect x="{LEFT}" y="{k * ROW + 3}" width="{long:.1f}" height="{ROW - 7}" fill="{colour}"/>'
            f'<text x="{LEFT + long + 6:.1f}" y="{middle}">{number(1e3 * size)} mm</text>'
        )
    return (
        f'<svg class="bars" role="img" aria-label="{text(title)}: {text(words)}" '
        f'viewBox="0 0 {WIDTH} {len(rows) * ROW}" font-size="13" font-family="system-ui, sans-serif" '
        f'fill="#1a1a1a">{"".join(parts)}</svg>'
    )
