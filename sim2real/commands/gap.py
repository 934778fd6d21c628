"""What physics that the simulator lacks costs a player on a table, and how much a diagnosis wins back.

The whole circle, on a twin whose physics is concealed or at a physical table: the player plays there, some of that play
is recorded and diagnosed, the player is fine-tuned in the simulator with what was found, and plays again, in games of
the same seeds. Beside it stand the usual answers, with as much training where they learn: an arm each. A stage keeps
what it made in --out, and the same command goes on where it was stopped; --stage runs one alone. Each of several tables
has a folder there, beside a page over all; what is learnt the same for each of them is learnt once. Scores are goals a
minute, over opponents the mean, with 95 % intervals."""

from __future__ import annotations

import argparse
import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim2real.gap.circle_folder import Conditions

MOST_GAMES, MOST_STEPS = 10_000, 10**10
MINUTES = 30.0  # of fine-tuning
PLAYER = "policy:table_champion"
TABLE = "walls"
OPPONENTS = ("interceptor", "follower", "bank_shot")  # against which goals are scored and conceded


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("player", nargs="?", default=PLAYER, metavar="PLAYER", help=f"({PLAYER})")
    parser.add_argument("--backend", default="twin", metavar="NAME", help="twin (default) or table, a physical one")
    parser.add_argument(
        "--table", action="append", metavar="NAME",
        help=f"of the twin, what is concealed ({TABLE}), may be given several times; or a physical one's table.toml",
    )  # fmt: skip
    parser.add_argument("--list", action="store_true", help="list the concealed tables, arms and stages, and end")
    parser.add_argument("--arms", nargs="+", metavar="ARM", help="what is compared (all)")
    parser.add_argument(
        "--opponent", action="append", metavar="PLAYER",
        help=f"the hand at the other end ({', '.join(OPPONENTS)} in turn), of a physical table in the simulator alone; "
        "may be given several times",
    )  # fmt: skip
    parser.add_argument(
        "--games",
        type=int,
        default=40,
        metavar="N",
        help="of each player on the table, two or more against each opponent (40)",
    )
    parser.add_argument(
        "--seconds", type=float, default=60.0, metavar="S", help="of play of a game, match by match (60)"
    )
    parser.add_argument("--recorded", type=int, default=5, metavar="N", help="games that are recorded (5)")
    parser.add_argument("--minutes", type=float, metavar="M", help="of fine-tuning of each arm (30)")
    parser.add_argument(
        "--steps", type=int, metavar="N", help="of fine-tuning, in place of --minutes, rounded up to whole rounds"
    )
    parser.add_argument("--seed", type=int, default=0, help="of the first game, and of learning (0)")
    parser.add_argument("--stage", metavar="NAME", help="run it alone, on what those before it left (all)")
    parser.add_argument("--processes", type=int, default=2, metavar="N", help="that play or learn at once (2)")
    parser.add_argument(
        "--together", nargs="+", type=Path, metavar="DIR", help="go round no more: one page over circles that are done"
    )
    parser.add_argument("--out", type=Path, default=Path("out/gap"), metavar="DIR", help="(out/gap)")
    parser.add_argument("--json", action="store_true", help="print gap.json instead of the summary")


def run(args: argparse.Namespace) -> int:
    """Go round. Returns 0. ValueError, in one line, for what cannot be."""
    from sim2real.gap.arms import ARMS
    from sim2real.gap.gap_table import TWIN
    from sim2real.gap.stages import LAST, STAGES

    if args.list:
        print("\n".join(_listed()))
        return 0
    if args.together:
        return _together(args.together, args.out, args.json)
    arms = args.arms or [name for name, arm in ARMS.items() if args.backend == TWIN or not arm.needs_truth]
    stages = [args.stage] if args.stage else list(STAGES)
    _check(args, arms, stages)
    circles = _circles(args)
    for folder, conditions in circles.items():
        _go_round(args, folder, conditions, arms, stages)
    if stages[-1] != LAST:
        print(json.dumps({"stage": args.stage}) if args.json else f"the stage {args.stage} is done in {args.out}")
    elif len(circles) > 1:
        _together(list(circles), args.out, args.json)
    elif args.json:
        print((args.out / "gap.json").read_text(encoding="utf-8"), end="")
    return 0


def _check(args: argparse.Namespace, arms: list[str], stages: list[str]) -> None:
    """ValueError, in one line, for what cannot be, before any work is done."""
    from baselines import find_player
    from puckpilot_env.files.toml_file import refuse_unknown
    from puckpilot_env.options.inputs import seed_number, whole_number
    from sim2real.gap.arms import ARMS
    from sim2real.gap.gap_table import PHYSICAL
    from sim2real.gap.residual_fit import require_sklearn
    from sim2real.gap.stages import STAGES
    from sim2real.gap.tuning import FEWEST_STEPS, require_training

    refuse_unknown(arms, ARMS, "arm")
    refuse_unknown(stages, STAGES, "stage")
    _check_tables(args, arms)
    for name, given in (("--arms", arms), ("--table", args.table or ()), ("--opponent", args.opponent or ())):
        if twice := [one for one in given if given.count(one) > 1]:
            raise ValueError(f"{name} names {twice[0]} more than once; name it once")
    if any(ARMS[name].simulator for name in arms):
        require_training()
    if "residual" in arms:
        require_sklearn()
    opponents = args.opponent or OPPONENTS
    for name in (args.player, *opponents):
        find_player(name)
    whole_number(args.processes, "--processes", 1, 64)
    fewest = 2 if args.backend == PHYSICAL else 2 * len(opponents)
    if args.games < fewest and fewest > 2:
        raise ValueError(
            f"--games is {args.games}; expected {fewest} or more, two against each of {', '.join(opponents)}"
        )
    whole_number(args.games, "--games", fewest, MOST_GAMES)
    whole_number(args.recorded, "--recorded", 1, args.games)
    seed_number(args.seed)
    if args.steps is not None and args.minutes is not None:
        raise ValueError("--minutes and --steps are both given; leave one of the two out")
    if args.steps is not None:
        whole_number(args.steps, "--steps", 1, MOST_STEPS)
        if args.steps < FEWEST_STEPS:
            words = "in fewer the critic alone learns, and the player stays as it is"
            raise ValueError(f"--steps is {args.steps:,}; expected {FEWEST_STEPS:,} or more: {words}")
    for name in ("seconds", "minutes"):
        given = getattr(args, name)
        if given is not None and not 0.0 < given <= 1e5:
            raise ValueError(f"--{name} is {given:g}; expected more than 0, at most 1e5")


def _check_tables(args: argparse.Namespace, arms: list[str]) -> None:
    from puckpilot_env.files.toml_file import refuse_unknown
    from sim2real.gap.arms import ARMS
    from sim2real.gap.gap_table import BACKENDS, PHYSICAL, find_gap_table

    refuse_unknown([args.backend], BACKENDS, "backend")
    if args.backend == PHYSICAL and len(args.table or ()) != 1:
        given = f"it is given {len(args.table)} times" if args.table else "puckpilot table check --example prints one"
        raise ValueError(f"--backend table needs one --table FILE; {given}")
    for name in args.table or [TABLE]:
        find_gap_table(args.backend, name)
    impossible = [name for name in arms if ARMS[name].needs_truth and args.backend == PHYSICAL]
    if impossible:
        raise ValueError(f"--arms {impossible[0]} needs a truth that is known; leave it out with --backend table")


def _circles(args: argparse.Namespace) -> dict[Path, Conditions]:
    """What is asked for: the conditions of each circle, by its folder."""
    from sim2real.gap.circle_folder import Conditions
    from sim2real.gap.gap_table import PHYSICAL

    tables, digest = args.table or [TABLE], ""
    if args.backend == PHYSICAL:
        tables = [str(Path(tables[0]).absolute())]
        digest = hashlib.sha256(Path(tables[0]).read_bytes()).hexdigest()[:12]
    given: dict[str, Any] = {
        "player": args.player, "opponents": tuple(args.opponent or OPPONENTS), "backend": args.backend,
        **{name: getattr(args, name) for name in ("games", "seconds", "recorded", "steps", "seed")},
        "minutes": MINUTES if args.minutes is None and args.steps is None else args.minutes, "table_contents": digest,
    }  # fmt: skip
    return {args.out / one if len(tables) > 1 else args.out: Conditions(table=one, **given) for one in tables}


def _go_round(
    args: argparse.Namespace, folder: Path, conditions: Conditions, arms: list[str], stages: list[str]
) -> None:
    """The stages of one circle, with what it comes to if they are all of them."""
    from baselines.commands.options import progress_bar
    from sim2real.gap.circle import Circle
    from sim2real.gap.circle_folder import SHARED
    from sim2real.gap.report.circle_words import circle_lines
    from sim2real.gap.stages import LAST

    report = (lambda line: None) if args.json else lambda line: print(line, flush=True)
    words = conditions.gap_table.words
    report(words if conditions.physical else f"{conditions.table}: {words}")
    shared = None if folder == args.out else args.out / SHARED
    circle = Circle(folder, conditions, args.processes, report, shared)
    with progress_bar("games on the table") as progress:
        for stage in stages:
            circle.run_stage(stage, arms, progress)
    if stages[-1] == LAST:
        report("\n".join([*circle_lines(circle.kept()), f"wrote {folder / 'gap.html'}"]))


def _together(folders: list[Path], out: Path, as_json: bool) -> int:
    """Write the page over the circles in `folders`."""
    from puckpilot_env.files.whole_file import write_text_whole
    from sim2real.gap.overview import overview, read_circle
    from sim2real.gap.report.overview_page import overview_page
    from sim2real.gap.report.overview_words import overview_lines

    result = overview([read_circle(folder) for folder in folders])
    out.mkdir(parents=True, exist_ok=True)
    text = json.dumps(result, indent=1)
    write_text_whole(out / "overview.json", text + "\n")
    write_text_whole(out / "overview.html", overview_page(result, [str(one) for one in folders]))
    if as_json:
        print(text)
    else:
        print("\n".join([*overview_lines(result), f"wrote {out / 'overview.json'}, {out / 'overview.html'}"]))
    return 0


def _listed() -> list[str]:
    from sim2real.gap.arms import ARMS
    from sim2real.gap.stages import STAGES
    from sim2real.table.twin.concealed import TABLES

    lines = []
    for title, rows in (("tables", TABLES), ("arms", ARMS)):
        lines += [title, *(f"  {name:12} {row.words}" for name, row in rows.items())]
    return [*lines, "stages", *(f"  {name:12} {stage.__doc__}" for name, stage in STAGES.items())]
