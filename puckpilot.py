"""The command `puckpilot`: a table of sub-commands, each loaded when it is called."""

from __future__ import annotations

import argparse
import difflib
import importlib
import os
import re
import shutil
import signal
import sys
import textwrap
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from typing import NoReturn

# The matrices of a diagnosis are small: a second thread of linear algebra makes it three to six times slower.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# name, of one word or two: (module with `add_arguments` and `run`, what it does)
COMMANDS = {
    "demo": (
        "sim2real.commands.demo",
        "a first look: players meet, a game is filmed, a recording is compared and diagnosed",
    ),
    "envs": ("puckpilot_env.commands.envs", "list the environments, or show the page of one"),
    "check": ("puckpilot_env.commands.check", "does an environment keep its promises?"),
    "match": ("baselines.commands.match", "two players against each other, in paired games"),
    "tournament": ("baselines.commands.tournament", "all against all: payoff matrix and ratings"),
    "train": ("agents.commands.train", "train a player by self-play"),
    "evaluate": ("agents.commands.evaluate", "how good a player is, and whether it could play on a gantry"),
    "exploit": ("agents.commands.exploit", "how exploitable a player is: a fresh learner meets it alone"),
    "export": ("agents.commands.export", "write a policy as .npz or .onnx"),
    "benchmark run": ("agents.commands.benchmark_run", "let algorithms learn the benchmark's tasks"),
    "benchmark report": ("agents.commands.benchmark_report", "tables and figures of what algorithms learnt"),
    "benchmark enter": ("agents.commands.benchmark_enter", "make a player's entry for the leaderboard"),
    "benchmark verify": ("agents.commands.benchmark_verify", "does an entry of the leaderboard hold?"),
    "bench": ("puckpilot_env.commands.bench", "how fast the simulator is here"),
    "bench vision": ("sim2real.commands.bench_vision", "how exact and how fast the vision is here"),
    "bench diagnosis": ("sim2real.commands.bench_diagnosis", "what a diagnosis costs here, by the length of the play"),
    "bench table": ("sim2real.commands.bench_table", "how fast this machine reacts at a table, in real time"),
    "bench twin": ("sim2real.commands.bench_twin", "how fast the twin is here, and whether it plays as the simulator"),
    "bench arena": ("sim2real.commands.bench_arena", "how quick the arena is here, behind bad lines and under load"),
    "play": ("sim2real.commands.play", "a player at the robot's seat of a table: firmware, camera and all, on a twin"),
    "table check": ("sim2real.commands.table_check", "bring a table up, step by step: what works, and what to mend"),
    "table drill": ("sim2real.commands.table_drill", "faults at random moments on a twin: does the mallet stop?"),
    "record": ("sim2real.commands.record", "camera and board of a table, in one recording, while a program excites it"),
    "latency": ("sim2real.commands.latency", "the delay of a table's loop, in parts with intervals"),
    "compare": ("sim2real.commands.compare", "where a recording of a table departs from the simulator"),
    "diagnose": ("sim2real.commands.diagnose", "which physics the simulator lacks, with proof on untouched data"),
    "gap": ("sim2real.commands.gap", "what unmodelled physics costs a player, and how much a diagnosis wins back"),
    "study": ("sim2real.commands.study", "how often a diagnosis is right, on cases with something hidden"),
    "calibrate camera": ("sim2real.commands.calibrate_camera", "a camera's intrinsics, from photographs of a board"),
    "calibrate table": ("sim2real.commands.calibrate_table", "markers and surface of a table, from photographs of it"),
    "calibrate gantry": ("sim2real.commands.calibrate_gantry", "the pulley's radius, the mallet moved by hand"),
    "identify gantry": ("sim2real.commands.identify_gantry", "the gantry's constants, from logs of its motors"),
    "identify puck": ("sim2real.commands.identify_puck", "friction, drag and restitution, from recordings of the puck"),
    "track": ("sim2real.commands.track", "puck and opponent in a camera's pictures, as a recording"),
    "arena": ("sim2real.commands.arena", "play in a browser, or watch two players"),
    "firmware info": ("sim2real.commands.firmware_info", "the microcontroller's program: protocol, size, speed"),
    "firmware build": ("sim2real.commands.firmware_build", "compile the microcontroller's program"),
    "firmware emulate": ("sim2real.commands.firmware_emulate", "run the microcontroller's program without a board"),
    "link monitor": ("sim2real.commands.link_monitor", "watch the line to the microcontroller"),
    "link test": ("sim2real.commands.link_test", "test the line to the microcontroller"),
}


# Packages that some commands alone need, and by which of the project's extras they come
EXTRAS = {"unicorn": "emulate", "torch": "train", "rsl_rl": "train", "tensordict": "train", "sklearn": "train",
          "stable_baselines3": "benchmark", "torchrl": "benchmark", "aiohttp": "arena"}  # fmt: skip


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message}; see {self.prog} --help", file=sys.stderr)
        raise SystemExit(2)


def _table(names: Iterable[str]) -> str:
    width = max(map(len, names := list(names)))
    return "\n".join(f"  {name:{width}}  {COMMANDS[name][1]}" for name in names)


def _overview() -> str:
    return (
        "usage: puckpilot COMMAND [options]\n\nAir hockey for learning robots: simulator, environments, players, and "
        f"the gap to the table.\n\n{_table(COMMANDS)}\n\n"
        "puckpilot COMMAND --help explains one. First of all: puckpilot demo"
    )


def _kinds(word: str) -> list[str]:
    """The commands of two words that begin with this one."""
    return [name for name in COMMANDS if name.startswith(f"{word} ")]


def _paragraphs(text: str) -> str:
    """A docstring for the terminal: its paragraphs, and the items of its lists, wrapped each by itself."""
    width = min(shutil.get_terminal_size().columns, 100) - 2
    items = re.split(r"\n\s*\n|\n(?=- |\d\. )", text.strip())
    return "\n".join(
        textwrap.fill(" ".join(item.split()), width, subsequent_indent="  " * (item[0] in "-1234")) for item in items
    )


def _unknown(words: list[str]) -> str:
    kinds = _kinds(words[0])
    known = kinds or list(COMMANDS)
    name = " ".join(words[:2]) if kinds else words[0]
    near = difflib.get_close_matches(name, known if kinds else [*known, *(one.split()[0] for one in known)], n=1)
    hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(known)}"
    return f"puckpilot: unknown command '{name}'; {hint}"


@contextmanager
def _orderly_end() -> Iterator[None]:
    """Inside, a request to end (SIGTERM, or SIGHUP of a closed terminal) is as Ctrl-C: no draft of a file is left.

    Libraries may lose the interrupt and fail of it: the failure after a request is taken for its effect, and what their
    callbacks cannot raise is not printed.
    """
    requests: list[int] = []
    report = sys.unraisablehook

    def stop(number: int, frame: object) -> NoReturn:
        requests.append(number)
        raise _interrupt(number)

    defaults = {signal.SIGINT: signal.default_int_handler}
    defaults |= {getattr(signal, name): signal.SIG_DFL for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)}
    ours = threading.current_thread() is threading.main_thread()  # no other may set handlers
    kept = [number for number in defaults if ours and signal.getsignal(number) is defaults[number]]  # nohup ignores one
    for number in kept:
        signal.signal(number, stop)
    sys.unraisablehook = lambda lost: None if requests else report(lost)
    try:
        yield
    except Exception as error:
        if requests:
            raise _interrupt(requests[0]) from error
        raise
    finally:
        sys.unraisablehook = report
        for number in kept:
            signal.signal(number, defaults[number])


def _interrupt(number: int) -> KeyboardInterrupt:
    """What a signal raises: Ctrl-C as Python has it, any other with its number."""
    return KeyboardInterrupt() if number == signal.SIGINT else KeyboardInterrupt(number)


def _loaded(name: str) -> tuple[argparse.ArgumentParser, Callable[[argparse.Namespace], int]]:
    """The parser of a command's arguments, and what runs it."""
    module_name, what = COMMANDS[name]
    module = importlib.import_module(module_name)
    parser = _Parser(
        prog=f"puckpilot {name}",
        description=_paragraphs(module.__doc__ or what),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    module.add_arguments(parser)
    return parser, module.run


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one sub-command. 0: did it; 1: did it, and the answer is bad news; 2: could not, with one line why."""
    try:
        return _run(list(sys.argv[1:] if arguments is None else arguments))
    except BrokenPipeError:  # the reader, `head` say, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _run(words: list[str]) -> int:
    if words[:1] == ["--version"]:
        print(f"puckpilot {version('puckpilot')}")
        return 0
    if not words or words[0] in ("-h", "--help"):
        print(_overview(), flush=True)
        return 0 if words else 2
    many = 2 if " ".join(words[:2]) in COMMANDS else 1
    name, rest = " ".join(words[:many]), words[many:]
    if name not in COMMANDS and _kinds(name) and rest[:1] in ([], ["-h"], ["--help"]):
        print(f"usage: puckpilot {name} KIND [options]\n\n{_table(_kinds(name))}")
        return 0 if rest else 2
    if name not in COMMANDS:
        print(_unknown(words), file=sys.stderr)
        return 2
    try:
        with _orderly_end():
            parser, run = _loaded(name)
            return run(parser.parse_args(rest))
    except BrokenPipeError:
        raise
    except KeyboardInterrupt as stop:
        print(f"puckpilot {name}: stopped", file=sys.stderr)
        return 128 + (stop.args[0] if stop.args else signal.SIGINT)
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        print(f"puckpilot {name}: {place}{error.strerror or error}; give another path", file=sys.stderr)
        return 2
    except ValueError as error:
        print(f"puckpilot {name}: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package not in EXTRAS:
            raise
        print(
            f"puckpilot {name}: needs {package}; install it with: pip install 'puckpilot[{EXTRAS[package]}]'",
            file=sys.stderr,
        )
        return 2
    except MemoryError:
        print(f"puckpilot {name}: not enough memory for so many tables at once; ask for fewer", file=sys.stderr)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
