"""The page of a circle: the score from lost to won back, what was found, and how to do it again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from sim2real.diagnose.report import page as diagnosis_page
from sim2real.diagnose.report.charts import BLUE, GREY
from sim2real.diagnose.report.inline_svg import inline_svg
from sim2real.gap.arms import ARMS
from sim2real.gap.circle_folder import BEFORE, training_words
from sim2real.gap.gap_table import TWIN, GapTable
from sim2real.gap.in_simulator import TRUTH, UNCHANGED
from sim2real.gap.report.found_words import against_rows, found_words, learnt_words
from sim2real.table.game.shots import Shots

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TEMPLATES = Path(__file__).parent / "templates"
WIDTH, ROW, LEFT = 560.0, 26.0, 150.0  # points
SIMULATED, PLAYED = "in the simulator", "on the table, as it is"
SIMULATORS = ("simulator, no effect", "simulator, what is concealed")
FILES = (
    "before/: the games on the table, with the recordings of the first of them",
    "diagnosis/: what these say, report.html, effects.toml and draws.toml",
    "ARM/training/: a run of puckpilot train; ARM/games/: its player on the table",
    "gap.json: all numbers of this page",
)
FILMS = "before/film.gif, ARM/film.gif: the first game of each player on the table"


def environment() -> Environment:
    """The templates of the gap's pages, with the parts and the style of a diagnosis' report."""
    return Environment(
        loader=FileSystemLoader([TEMPLATES, diagnosis_page.TEMPLATES]), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True,
    )  # fmt: skip


def page(result: dict[str, Any], table: GapTable) -> str:
    """The result of a circle at a table, see `result.result`, as one HTML page without scripts, self-contained but for
    films."""
    conditions, concealed = result["conditions"], table.concealed is not None
    opponents = list(conditions["opponents"])
    return (
        environment()
        .get_template("gap.html.j2")
        .render(
            title=f"{conditions['player']} on {f'a table with {table.words}' if concealed else table.words}",
            conditions=conditions,
            concealed=concealed,
            training=training_words(conditions["minutes"], conditions["steps"]),
            words=table.words,
            chart=_chart(result),
            rows=_rows(result),
            shots=_shots(result),
            opponents=opponents,
            against=_against(result) if concealed and len(opponents) > 1 else [],
            simulated=_simulated(result),
            simulators=SIMULATORS[: len(result["in_simulator"][BEFORE])],
            films=_films(result),
            found=found_words(result),
            learnt=learnt_words(result["learnt"]),
            beside_truth=against_rows(result["against_truth"] or []),
            command=_command(conditions, list(result["arms"])),
            files=[*FILES, *([FILMS] if concealed else [])],
        )
    )


def _rows(result: dict[str, Any]) -> list[list[str]]:
    simulated = result["simulator"]
    net = simulated["scored"] - simulated["conceded"]
    rows = [[SIMULATED, f"{simulated['scored']:.2f}", f"{simulated['conceded']:.2f}", f"{net:.2f}", "", "", "", ""]]
    rows = rows if result["against_truth"] is not None else []  # else it is against another opponent
    rows.append([PLAYED, *_rates(result["before"]), "", "", str(result["before"]["stops"])])
    for name, arm in result["arms"].items():
        change = arm["change"]
        rows.append(
            [
                f"{name}: {ARMS[name].words}", *_rates(arm), f"{change['value']:+.2f}",
                f"{change['low']:+.2f} to {change['high']:+.2f}", str(arm["stops"]),
            ]
        )  # fmt: skip
    return rows


def _shots(result: dict[str, Any]) -> list[list[str]]:
    """How the shots of each player's games ended."""
    players = {PLAYED: result["before"], **result["arms"]}
    rows = []
    for name, one in players.items():
        shots = Shots(**one["shots"])
        kept = f"{100.0 * (1.0 - shots.let_in / shots.faced):.0f} %" if shots.faced else ""
        made = f"{100.0 * shots.scored / shots.made:.0f} %" if shots.made else ""
        kinds = [str(getattr(shots, kind)) for kind in ("late", "bounce", "straight", "deflected")]
        rows.append([name, str(shots.faced), kept, *kinds, str(shots.made), made, str(shots.missed)])
    return rows


def _against(result: dict[str, Any]) -> list[list[str]]:
    """Each player's goals for and against, a minute, against each opponent."""
    players = {PLAYED: result["before"], **result["arms"]}
    rows = []
    for name, one in players.items():
        rates = [[of[side]["value"] for side in ("scored", "conceded")] for of in one["against"].values()]
        rows.append([name, *(f"{scored:.2f} : {conceded:.2f}" for scored, conceded in rates)])
    return rows


def _simulated(result: dict[str, Any]) -> list[list[str]]:
    """Each player's net score in the simulator, on tables without an effect and, where that is known, with what is
    concealed, and on the table."""
    rows = []
    for name, tables in result["in_simulator"].items():
        nets = [tables[one]["scored"] - tables[one]["conceded"] for one in (UNCHANGED, TRUTH) if one in tables]
        played = result["before"] if name == BEFORE else result["arms"][name]
        rows.append([PLAYED if name == BEFORE else name, *(f"{one:.2f}" for one in (*nets, played["net"]["value"]))])
    return rows


def _films(result: dict[str, Any]) -> list[tuple[str, str]]:
    """The path of each film, and its caption."""
    return [
        (path, PLAYED if name == BEFORE else f"{name}: {ARMS[name].words}") for name, path in result["films"].items()
    ]


def _rates(one: dict[str, Any]) -> list[str]:
    net = one["net"]
    return [
        f"{one['scored']['value']:.2f}", f"{one['conceded']['value']:.2f}", f"{net['value']:.2f}",
        f"{net['low']:.2f} to {net['high']:.2f}",
    ]  # fmt: skip


def _chart(result: dict[str, Any]) -> str:
    """The net scores, one below the other, with the simulator's as a line, where that is against the same hands."""
    simulated = result["simulator"]["scored"] - result["simulator"]["conceded"]
    bars = {PLAYED: result["before"]["net"], **{name: arm["net"] for name, arm in result["arms"].items()}}

    def draw(axes: Axes) -> None:
        places = range(len(bars))
        values = [bar["value"] for bar in bars.values()]
        errors = [
            [bar["value"] - bar["low"] for bar in bars.values()],
            [bar["high"] - bar["value"] for bar in bars.values()],
        ]
        if result["against_truth"] is not None:
            axes.axvline(simulated, color=GREY, linestyle="--", label=SIMULATED)
        axes.errorbar(values, places, xerr=errors, fmt="s", color=BLUE, capsize=3.0)
        axes.set_yticks(places, list(bars))
        axes.set_ylim(len(bars) - 0.5, -0.5)
        axes.set_xlabel("goals for less goals against, a minute")

    return inline_svg("Net score of each player", WIDTH, ROW * len(bars) + 70.0, draw, (LEFT, 24.0, 40.0))


def _exactly(number: float) -> str:
    return str(int(number)) if number == int(number) else repr(number)


def _command(conditions: dict[str, Any], arms: list[str]) -> str:
    words = {
        **({} if conditions["backend"] == TWIN else {"backend": conditions["backend"]}),
        "table": conditions["table"], "opponent": " --opponent ".join(conditions["opponents"]),
        **{name: _exactly(conditions[name]) for name in ("games", "seconds", "recorded")},
        **{name: _exactly(conditions[name]) for name in ("minutes", "steps") if conditions[name]},
        "seed": str(conditions["seed"]), "arms": " ".join(arms),
    }  # fmt: skip
    return " ".join(["puckpilot gap", conditions["player"], *(f"--{name} {one}" for name, one in words.items())])
