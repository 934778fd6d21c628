"""The command `puckpilot`: help, errors in one line, figures as JSON, and nothing loaded before it is needed."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

import puckpilot
from tests.places import ROOT

OPTIONS = {
    "demo": ["--games", "--seed", "--out", "--json"],
    "envs": ["--json", "--write-pages"],
    "check": ["--steps", "--seed", "--json"],
    "match": ["--games", "--video", "--variant", "--seed", "--threads", "--json"],
    "tournament": ["--games", "--out", "--played", "--variant", "--seed", "--threads", "--json"],
    "train": [
        "--show-preset",
        "--preset",
        "--out",
        "--steps",
        "--minutes",
        "--resume",
        "--start",
        "--variant",
        "--device",
        "--at-table",
        "--effects",
        "--draws",
        "--residual",
        "--seed",
        "--threads",
    ],
    "evaluate": ["--games", "--against", "--variants", "--hampered", "--seed", "--workers", "--cluster", "--json"],
    "exploit": [
        "--steps",
        "--responses",
        "--out",
        "--preset",
        "--variant",
        "--games",
        "--seed",
        "--threads",
        "--workers",
        "--cluster",
        "--json",
    ],
    "export": ["--out"],
    "arena": ["--seat", "--host", "--port", "--out", "--name", "--seed", "--concealed", "--quick", "--diagnosis"],
    "benchmark run": ["--list", "--tasks", "--seeds", "--steps", "--out", "--workers", "--cluster", "--json"],
    "benchmark report": ["--json"],
    "benchmark enter": ["--name", "--trained", "--tasks", "--out"],
    "benchmark verify": ["--games", "--seed", "--seconds", "--memory", "--json"],
    "bench": ["--tables", "--threads", "--seconds", "--against", "--dicts", "--startup", "--json"],
    "bench diagnosis": ["--seconds", "--mechanism", "--seed", "--json"],
    "bench arena": ["--leaps", "--seconds", "--seed", "--json"],
    "bench table": ["--seconds", "--period", "--json"],
    "bench twin": ["--opponent", "--variant", "--games", "--seconds", "--processes", "--folder", "--seed", "--json"],
    "table check": ["--home", "--example", "--json"],
    "table drill": ["--minutes", "--player", "--seed", "--processes", "--out", "--json"],
    "bench vision": ["--pictures", "--seed", "--json"],
    "play": [
        "--backend",
        "--opponent",
        "--camera",
        "--table",
        "--recording",
        "--variant",
        "--games",
        "--seconds",
        "--record",
        "--seed",
        "--view",
        "--arena",
        "--port",
        "--json",
    ],
    "record": [
        "--backend",
        "--table",
        "--camera",
        "--program",
        "--seconds",
        "--volts",
        "--player",
        "--opponent",
        "--seed",
        "--json",
    ],
    "latency": ["--backend", "--seconds", "--seed", "--inject", "--json"],
    "compare": ["--json", "--out"],
    "diagnose": ["--holdout", "--baseline", "--out", "--json"],
    "gap": [
        "--backend",
        "--table",
        "--list",
        "--arms",
        "--opponent",
        "--games",
        "--seconds",
        "--recorded",
        "--minutes",
        "--steps",
        "--seed",
        "--stage",
        "--processes",
        "--together",
        "--out",
        "--json",
    ],
    "study": ["--cases", "--seed", "--out", "--only", "--mechanism", "--filmed", "--peer", "--workers", "--json"],
    "calibrate gantry": ["--baud", "--width", "--mallet-radius", "--jig", "--out", "--json"],
    "calibrate camera": ["--board", "--charuco", "--marker", "--out", "--json"],
    "calibrate table": ["--camera", "--out", "--check", "--json"],
    "identify gantry": ["--holdout", "--out", "--json"],
    "identify puck": ["--holdout", "--out", "--json"],
    "firmware info": ["--json"],
    "firmware build": [],
    "firmware emulate": ["--port", "--seconds", "--place"],
    "track": [
        "--calibration",
        "--out",
        "--video",
        "--ring-height",
        "--puck-radius",
        "--level",
        "--rate",
        "--exposure",
        "--seconds",
        "--json",
    ],
    "link monitor": ["--baud", "--seconds", "--json"],
    "link test": ["--baud", "--pings", "--json"],
}
DUMPS = "TypeError: dumps() missing 1 required positional argument: 'obj'"
HEAVY = ("numba", "pettingzoo", "gymnasium", "matplotlib", "rich", "scipy", "cv2", "torch", "numpy")


def refused(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Run a command that cannot be; its one line on stderr."""
    try:
        code = puckpilot.main(words)
    except SystemExit as stop:
        code = stop.code
    printed = capsys.readouterr()
    assert code == 2 and printed.out == ""
    assert printed.err.endswith("\n") and printed.err.count("\n") == 1
    return printed.err.strip()


def test_every_command_is_tested_here():
    assert set(OPTIONS) == set(puckpilot.COMMANDS)


@pytest.mark.parametrize("name", OPTIONS)
def test_help_names_the_options(name, capsys):
    with pytest.raises(SystemExit) as stop:
        puckpilot.main([*name.split(), "--help"])
    expected = capsys.readouterr().out
    assert stop.value.code == 0 and expected.startswith(f"usage: puckpilot {name} ")
    explained = expected[expected.index("options:") :]
    for option in OPTIONS[name]:
        assert f"\n  {option}" in explained, option


@pytest.mark.parametrize("word", ["-h", "--help"])
def test_overview(word, capsys):
    assert puckpilot.main([word]) == 0
    expected = capsys.readouterr().out
    for name, (_, what) in puckpilot.COMMANDS.items():
        assert name in expected and what in expected


@pytest.mark.parametrize("more, code", [([], 2), (["-h"], 0), (["--help"], 0)])
def test_a_word_of_several_commands_tells_them(more, code, capsys):
    assert puckpilot.main(["calibrate", *more]) == code
    expected = capsys.readouterr().out.splitlines()
    assert expected[0] == "usage: puckpilot calibrate KIND [options]"
    assert [line.split()[:2] for line in expected[2:]] == [
        ["calibrate", kind] for kind in ("camera", "table", "gantry")
    ]


@pytest.mark.parametrize(
    "words, expected",
    [
        (["calibrate", "tabel", "x"], "puckpilot: unknown command 'calibrate tabel'; did you mean 'calibrate table'?"),
        (["link", "/dev/ttyUSB0"], "puckpilot: unknown command 'link /dev/ttyUSB0'; known: link monitor, link test"),
        (["calibrat"], "puckpilot: unknown command 'calibrat'; did you mean 'calibrate'?"),
        (["bensh"], "puckpilot: unknown command 'bensh'; did you mean 'bench'?"),
        (["xyz"], "puckpilot: unknown command 'xyz'; known: " + ", ".join(puckpilot.COMMANDS)),
        (
            ["bench", "--tabels", "3"],
            "puckpilot bench: unrecognized arguments: --tabels; see puckpilot bench --help",
        ),
        (
            ["bench", "--tables", "many"],
            "puckpilot bench: argument --tables: invalid int value: 'many'; see puckpilot bench --help",
        ),
        (["arena", "goaly"], "puckpilot arena: unknown player 'goaly'; did you mean 'goalie'?"),
        (
            ["arena", "still", "goalie", "still"],
            "puckpilot arena: players are still, goalie, still; expected each named once where more than two meet",
        ),
        (
            ["play", "still", "--port", "8000"],
            "puckpilot play: --port is given without --arena, of which it is; give both or none",
        ),
        (
            ["arena", "still", "--diagnosis", "x"],
            "puckpilot arena: --diagnosis is given without a recording; expected puckpilot arena RECORDING --diagnosis "
            "DIR",
        ),
        (
            ["bench", "mach-v0"],
            "puckpilot bench: unknown variant 'mach-v0'; did you mean 'puckpilot/match-v0'?",
        ),
        (
            ["envs", "matsch-v0"],
            "puckpilot envs: unknown variant 'matsch-v0'; did you mean 'puckpilot/match-v0'?",
        ),
        (["bench", "--tables", "0"], "puckpilot bench: tables is 0; expected a whole number from 1 to 1,000,000"),
        (
            ["bench", "--dicts", "--startup"],
            "puckpilot bench: argument --startup: not allowed with argument --dicts; see puckpilot bench --help",
        ),
        (["check", "match-v0", "--steps", "0"], "puckpilot check: steps is 0; expected at least 2"),
        (["check", "json:dumps"], "puckpilot check: cannot make 'json:dumps': " + DUMPS),
        (
            ["bench", "diagnosis", "--seconds", "5"],
            "puckpilot bench diagnosis: --seconds has 5; expected lengths from 20 to 3600 s",
        ),
        (["bench", "--threads", "0"], "puckpilot bench: threads is 0; expected a whole number from 1 to 256"),
        (["bench", "--seconds", "0"], "puckpilot bench: --seconds is 0; expected a number above 0, at most 3600"),
        (["bench", "--seconds", "nan"], "puckpilot bench: --seconds is nan; expected a number above 0, at most 3600"),
    ],
)
def test_mistakes_get_one_line(words, expected, capsys):
    assert refused(words, capsys) == expected


@pytest.mark.parametrize(("package", "extra"), [("unicorn.arm_const", "emulate"), ("torch", "train")])
def test_a_package_of_an_extra_that_is_missing_is_said_in_one_line(package, extra, monkeypatch, capsys):
    def lacking(name: str) -> None:
        raise ModuleNotFoundError(f"No module named '{package}'", name=package)

    monkeypatch.setattr(puckpilot.importlib, "import_module", lacking)
    assert puckpilot.main(["envs"]) == 2
    needs = package.partition(".")[0]
    assert capsys.readouterr().err == (
        f"puckpilot envs: needs {needs}; install it with: pip install 'puckpilot[{extra}]'\n"
    )


def test_a_package_of_no_extra_that_is_missing_is_an_error_of_the_program(monkeypatch):
    def lacking(name: str) -> None:
        raise ModuleNotFoundError("No module named 'nobody'", name="nobody")

    monkeypatch.setattr(puckpilot.importlib, "import_module", lacking)
    with pytest.raises(ModuleNotFoundError):
        puckpilot.main(["envs"])


@pytest.mark.skipif(os.name != "posix", reason="pipes of POSIX")
def test_a_reader_that_has_seen_enough_ends_the_overview_quietly():
    code = "import sys, time; time.sleep(0.5); import puckpilot; sys.exit(puckpilot.main(['--help']))"
    words = f'"{sys.executable}" -c "{code}" | true'
    done = subprocess.run(["sh", "-c", words], cwd=ROOT, capture_output=True, text=True)
    assert done.stderr == ""


@pytest.mark.parametrize("name", OPTIONS)
def test_every_command_refuses_an_unknown_option(name, capsys):
    assert refused([*name.split(), "--no-such-option"], capsys).startswith(f"puckpilot {name}: ")


@pytest.mark.parametrize(
    "words",
    [["check", "no-such-v0"], ["compare", "/no/such/folder"], ["envs", "no-such-v0"]],
)
def test_unknown_ids_and_folders(words, capsys):
    assert refused(words, capsys).startswith(f"puckpilot {words[0]}: ")


@pytest.mark.slow
def test_bench_prints_its_figures_as_json(capsys):
    words = ["bench", "defence-v0", "--tables", "8", "--seconds", "0.2", "--json"]
    assert puckpilot.main([*words, "--against", "attack-v0"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["id"] == "puckpilot/defence-v0" and report["against"] == "puckpilot/attack-v0"
    assert report["tables"] == 8 and report["threads"] == 1
    assert 1e3 < report["agent_steps_per_s"] <= report["fastest_stretch"] < 1e9
    # two agents to a table, 0.1 s of play to a step
    assert report["table_seconds_per_s"] == pytest.approx(report["agent_steps_per_s"] * 0.1 / 2)
    assert 0.05 < report["ratio"] < 20.0


def test_bench_of_dictionaries(capsys):
    assert puckpilot.main(["bench", "--dicts", "--seconds", "0.05", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["tables"] == 1 and report["agent_steps_per_s"] > 100


def test_envs_lists_every_id(capsys):
    assert puckpilot.main(["envs", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    files = sorted((ROOT / "puckpilot_env").glob("*_v0.py"))
    assert len(listed) == len(files) == 7


@pytest.mark.parametrize("code", ["import puckpilot", "import puckpilot; puckpilot.main(['--help'])"])
def test_nothing_heavy_is_loaded_at_start(code):
    script = f"{code}\nimport sys\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in done.stdout.split("\n")[-2].split()}
    assert "puckpilot" in loaded and not loaded & set(HEAVY)


def test_as_a_program():
    """Exit status and streams of a process, as a shell sees them."""
    done = subprocess.run([sys.executable, "puckpilot.py", "bensh"], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    done = subprocess.run([sys.executable, "puckpilot.py"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and "puckpilot demo" in done.stdout


@pytest.mark.parametrize(("given", "threads"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "3"}, "3")])
def test_linear_algebra_has_one_thread_unless_the_user_says_otherwise(given: dict[str, str], threads: str):
    script = "import puckpilot, sys, os; print('numpy' in sys.modules, os.environ['OPENBLAS_NUM_THREADS'])"
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"} | given
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.stdout.split() == ["False", threads]
