"""The page over several circles: what each table cost, and what each arm won back there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim2real.diagnose.report.charts import BLUE, GREY, ORANGE
from sim2real.diagnose.report.inline_svg import INK, inline_svg
from sim2real.gap.arms import ARMS, CEILING, OWN
from sim2real.gap.circle_folder import training_words
from sim2real.gap.report.page import environment
from sim2real.table.twin.concealed import TABLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, ROW, LEFT = 620.0, 20.0, 190.0  # points
ALL = "all but none"
COLORS = {OWN: BLUE, CEILING: GREY}
COUNTS = {"better": "tables", "clearly": "tables", "in_simulator": "simulated"}  # and of how many


def overview_page(result: dict[str, Any], folders: list[str]) -> str:
    """The `overview` of the circles in `folders` as one self-contained HTML page without scripts."""
    tables = {**{name: one["arms"] for name, one in result["tables"].items()}, ALL: result["all"]}
    return (
        environment()
        .get_template("overview.html.j2")
        .render(
            title=f"What the gap costs {result['conditions']['player']}, and what is won back",
            conditions=result["conditions"],
            training=training_words(result["conditions"]["minutes"], result["conditions"]["steps"]),
            arms={
                arm: row.words
                for arm, row in ARMS.items()
                if any(arm in one["arms"] for one in result["tables"].values())
            },
            chart=_chart(result["tables"]),
            tables=[_table_row(name, one) for name, one in result["tables"].items()],
            counts=[
                [arm, *(f"{one[name]} of {one[of]}" for name, of in COUNTS.items())]
                for arm, one in result["own_better_on"].items()
            ],
            rows=[_arm_row(name, arm, row) for name, arms in tables.items() for arm, row in arms.items()],
            command=f"puckpilot gap --together {' '.join(folders)}",
        )
    )


def _table_row(name: str, one: dict[str, Any]) -> list[str]:
    lost = one["simulator"] - one["before"]
    found = "; ".join(", ".join(each) or "nothing" for each in one["found"])
    return [
        f"{name}: {TABLES[name].words}", ", ".join(map(str, one["seeds"])), f"{one['simulator']:.2f}",
        f"{one['before']:.2f}", f"{lost:.2f}", found,
    ]  # fmt: skip


def _arm_row(table: str, arm: str, row: dict[str, Any]) -> list[str]:
    """A row; the share is left out where the ceiling's change is not above 0 beyond chance."""
    of_ceiling = row.get("share")
    simulated = "" if row["simulated"] is None else f"{row['simulated']:+.2f}"
    in_percent = of_ceiling and {name: 100.0 * value for name, value in of_ceiling.items()}
    return [
        f"{table}, {arm}", *_interval(row["change"], "{:+.2f}"), simulated,
        ", ".join(f"{one:+.2f}" for one in row["of_seeds"]) if table != ALL else "",
        *_interval(in_percent, "{:.0f} %"),
        *_interval(row.get("own_better_by"), "{:+.2f}"),
    ]  # fmt: skip


def _interval(rate: dict[str, float] | None, show: str) -> list[str]:
    if rate is None:
        return ["", ""]
    return [show.format(rate["value"]), f"{show.format(rate['low'])} to {show.format(rate['high'])}"]


def _chart(tables: dict[str, Any]) -> str:
    """What each arm won back on each table, one below the other."""
    bars = [(name, arm, row["change"]) for name, one in tables.items() for arm, row in one["arms"].items()]

    def draw(axes: Axes) -> None:
        axes.axvline(0.0, color=INK, linewidth=0.8)
        for place, (_, arm, change) in enumerate(bars):
            error = [[change["value"] - change["low"]], [change["high"] - change["value"]]]
            axes.errorbar(change["value"], place, xerr=error, fmt="s", color=COLORS.get(arm, ORANGE), capsize=2.0)
        axes.set_yticks(range(len(bars)), [f"{name}, {arm}" for name, arm, _ in bars])
        axes.set_ylim(len(bars) - 0.5, -0.5)
        axes.set_xlabel("net goals a minute won back")

    return inline_svg(
        "Net score won back by each arm on each table", WIDTH, ROW * len(bars) + 70.0, draw, (LEFT, 12.0, 40.0)
    )
