"""`puckpilot train`: what it writes to its folder, and what it refuses in one line."""

from __future__ import annotations

import errno
import json
from pathlib import Path

import pytest

from agents.training.checkpoint import load_checkpoint, save_checkpoint
from agents.training.preset import find_preset, read_preset
from puckpilot import main
from puckpilot_env.residual.network import no_residual

TINY = """
tables = 4
steps = 2
round = 1
flip = "rows"
[network]
hidden = [8]
distribution = "TanhNormal"
[ppo]
num_learning_epochs = 1
num_mini_batches = 1
gamma = 0.95
[rewards]
goal = 1.0
[league]
anchors = { still = 1 }
earlier = [1]
gate = 0.9
cap = 2
most = 2
"""
EACH = (2 * 2 + 2) * 2  # steps of a round: two tables of self-play with two learners, two with one


@pytest.fixture
def preset(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.toml"
    path.write_text(TINY)
    return path


def test_a_run_trains_the_given_steps_and_resumes(
    preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["train", "--out", str(tmp_path / "run")]
    assert main([*words, "--preset", str(preset), "--steps", str(2 * EACH)]) == 0
    assert f"{2 * EACH:,} steps; the player is" in " ".join(capsys.readouterr().out.split())
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert {"run.json", "checkpoint.pt", "curve.csv", "policy.npz", "selves"} <= names
    assert any(name.startswith("events.") for name in names)  # tensorboard's
    assert json.loads((tmp_path / "run" / "run.json").read_text())["preset"] == TINY
    preset.unlink()  # a run knows its own settings
    assert main([*words, "--resume", "--steps", str(3 * EACH)]) == 0
    assert len((tmp_path / "run" / "curve.csv").read_text().splitlines()) == 1 + 3
    player = f"policy:{tmp_path / 'run' / 'policy.npz'}"
    assert main(["match", player, "still", "--games", "2", "--variant", "defence-v0"]) == 0


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    capsys.readouterr()
    assert main(["train", *words]) == 2
    said = capsys.readouterr().err
    assert said.startswith("puckpilot train: ") and said.count("\n") == 1 and len(said) < 400
    return said


def test_a_folder_that_holds_a_run_is_refused_without_resume(
    preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--out", str(tmp_path / "run"), "--preset", str(preset), "--steps", "1"]
    assert main(["train", *words]) == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "run").iterdir() if path.is_file()}
    assert "holds a run already; --resume goes on with it" in refused(capsys, *words)
    assert before == {path.name: path.read_bytes() for path in (tmp_path / "run").iterdir() if path.is_file()}


def test_resuming_needs_a_run_that_can_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = tmp_path / "run"
    assert "no run in" in refused(capsys, "--resume", "--out", str(run))
    assert not run.exists()
    run.mkdir()
    for text, words in (("{", "is not JSON"), ("[]", "is not of the format"), ('{"format": "x"}', "is not of the")):
        (run / "run.json").write_text(text)
        assert words in refused(capsys, "--resume", "--out", str(run))
    (run / "run.json").write_text('{"format": "puckpilot-run-1", "variant": "match-v0"}')
    refused(capsys, "--resume", "--out", str(run))


def test_a_run_without_its_checkpoint_keeps_its_player(
    preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(tmp_path / "run")]
    assert main(["train", *out, "--preset", str(preset), "--steps", "1"]) == 0
    (tmp_path / "run" / "checkpoint.pt").unlink()
    before = {path.name: path.read_bytes() for path in (tmp_path / "run").glob("[cp]*")}
    assert f"--start {tmp_path / 'run' / 'policy.npz'}" in refused(capsys, *out, "--resume", "--steps", "99")
    assert "holds a run already" in refused(capsys, *out, "--preset", str(preset), "--steps", "1")
    assert {path.name: path.read_bytes() for path in (tmp_path / "run").glob("[cp]*")} == before


def test_a_run_of_two_processes_is_not_resumed_by_one(
    preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(tmp_path / "run")]
    assert main(["train", *out, "--preset", str(preset), "--steps", "1"]) == 0
    checkpoint = tmp_path / "run" / "checkpoint.pt"
    kept = load_checkpoint(checkpoint)
    save_checkpoint(checkpoint, {**kept, "others": [{name: kept[name] for name in ("tables", "torch_random")}]})
    said = refused(capsys, *out, "--resume", "--steps", "99")
    assert "2 processes side by side; these are 1: torchrun --nproc-per-node 2" in said


def test_a_run_that_needs_no_more_steps_says_so(
    preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["train", "--out", str(tmp_path / "run"), "--steps", "1"]
    assert main([*words, "--preset", str(preset)]) == 0
    assert "the rounds' medians: " in capsys.readouterr().out
    assert main([*words, "--resume"]) == 0
    assert "nothing was left to do" in capsys.readouterr().out


def test_a_full_disk_error_names_the_file(
    preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path, data: bytes) -> int:
        raise OSError(errno.ENOSPC, "no room")

    monkeypatch.setattr(Path, "write_bytes", full)
    said = refused(capsys, "--out", str(tmp_path / "run"), "--preset", str(preset), "--steps", "1")
    assert f"{tmp_path / 'run' / 'checkpoint.pt'}: No space left on device" in said


def test_a_preset_is_shown_and_can_be_trained_with(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(["train", "--show-preset", "paper"])
    assert end.value.code == 0 and read_preset(capsys.readouterr().out, "shown") == find_preset("paper")
    assert main(["train", "--show-preset", "papper"]) == 2


EFFECTS = 'format = "puckpilot-effects/1"\n[effects.table_tilt]\ntilt_x = {}\n'
DRAWS = 'format = "puckpilot-draws/1"\n[draws.tilt_y]\nlow = -0.01\nhigh = {}\nsource = "{}"\n'
# option: the run's value, a contradiction, the same value in other words, and how a message names the run's value
CONTRADICTIONS = {
    "variant": ("defence-v0", "match-v0", "puckpilot/defence-v0", "puckpilot/defence-v0"),
    "preset": ("tiny.toml", "fast", "same.toml", "one of its own, in run.json"),
    "seed": ("7", "0", "07", "7"),
    "threads": ("1", "2", "01", "1"),
    "effects": ("tilt.toml", "more.toml", "tilt_again.toml", "tilt_x 0.02"),
    "draws": ("drawn.toml", "drawn_more.toml", "drawn_again.toml", "others, in run.json"),
}


@pytest.fixture
def run(preset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run after its first round, of none but given options."""
    monkeypatch.chdir(tmp_path)
    for name, tilt in (("tilt", 0.02), ("tilt_again", 0.02), ("more", 0.03)):
        (tmp_path / f"{name}.toml").write_text(EFFECTS.format(tilt))
    for name, high in (("drawn", 0.01), ("drawn_again", 0.01), ("drawn_more", 0.02)):
        (tmp_path / f"{name}.toml").write_text(DRAWS.format(high, f"a level, {name}"))
    (tmp_path / "same.toml").write_text(TINY)
    words = [word for option, (has, *_) in CONTRADICTIONS.items() for word in (f"--{option}", has)]
    assert main(["train", "--out", "run", "--steps", "1", *words]) == 0
    return tmp_path / "run"


@pytest.mark.parametrize("option", CONTRADICTIONS)
def test_resuming_refuses_an_option_that_the_run_contradicts(
    option: str, run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path: path.read_bytes() for path in run.rglob("*") if path.is_file() and path.name != ".lock"}
    _, other, same, named = CONTRADICTIONS[option]
    words = ["--resume", "--out", "run", "--steps", str(2 * EACH)]
    assert refused(capsys, *words, f"--{option}", other) == (
        f"puckpilot train: --resume goes on with the run in run as it is, but --{option} is {other} where the run has "
        f"{named}; leave it out, or begin a new run in another folder\n"
    )
    assert before == {path: path.read_bytes() for path in run.rglob("*") if path.is_file() and path.name != ".lock"}
    assert main(["train", *words, f"--{option}", same]) == 0
    assert len((run / "curve.csv").read_text().splitlines()) == 1 + 2


def test_resuming_names_all_that_is_contradicted_and_nothing_that_was_not_given(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--resume", "--out", "run", "--steps", str(2 * EACH)]
    said = refused(capsys, *words, "--seed", "8", "--threads", "2", "--variant", "defence-v0")
    assert "but --seed is 8 where the run has 7, --threads is 2 where the run has 1; leave them out" in said
    assert "no preset 'nobody'; known: " in refused(capsys, *words, "--preset", "nobody")
    assert "no preset 'fasst'; did you mean 'fast'?" in refused(capsys, *words, "--preset", "fasst")
    assert "unknown variant 'chess-v0'" in refused(capsys, *words, "--variant", "chess-v0")
    assert "--start is for a new one" in refused(capsys, *words, "--start", "run")
    assert main(["train", *words]) == 0


def test_messages_name_a_shipped_preset_and_say_none_for_no_effects(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(
        json.dumps({**kept, "preset": find_preset("fast").text, "effects": None, "draws": None})
    )
    words = ["--resume", "--out", "run", "--preset", "paper", "--effects", "tilt.toml", "--draws", "drawn.toml"]
    said = refused(capsys, *words)
    assert "--preset is paper where the run has fast, --effects is tilt.toml where the run has none, " in said
    assert "--draws is drawn.toml where the run has none;" in said


def test_a_run_on_corrected_tables_resumes_with_its_network_alone(
    preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("net", "other"):
        no_residual().save(tmp_path / f"{name}.npz")
    words = ["--out", "run", "--preset", str(preset), "--residual", "net.npz"]
    said = refused(capsys, *words, "--variant", "match-randomized-v0")
    assert "cannot correct puckpilot/match-randomized-v0" in said and not (tmp_path / "run").exists()
    assert main(["train", *words, "--steps", "1"]) == 0
    assert json.loads((tmp_path / "run" / "run.json").read_text())["residual"] == str(tmp_path / "net.npz")
    again = ["--resume", "--out", "run", "--steps", str(2 * EACH)]
    said = refused(capsys, *again, "--residual", "other.npz")
    assert f"--residual is other.npz where the run has {tmp_path / 'net.npz'};" in said
    assert main(["train", *again, "--residual", "./net.npz"]) == 0
    (tmp_path / "net.npz").write_bytes(b"PK")
    assert f"{tmp_path / 'net.npz'}: is no network of residuals" in refused(capsys, *again)


OPTIONS = {
    "steps 0": ["--steps", "0"],
    "steps no number": ["--steps", "nan"],
    "minutes negative": ["--minutes", "-1"],
    "no such preset": ["--preset", "nobody"],
    "no such variant": ["--variant", "chess-v0"],
    "seed negative": ["--seed", "-1"],
    "threads 0": ["--threads", "0"],
    "threads negative": ["--threads", "-2"],
    "a device without torch": ["--device", "abacus"],
    "a GPU that is not there": ["--device", "cuda:99"],
    "no such effects": ["--effects", "no/such/file.toml"],
    "no such draws": ["--draws", "no/such/file.toml"],
    "no such network": ["--residual", "no/such/file.npz"],
}


@pytest.mark.parametrize("wrong", OPTIONS)
def test_invalid_options_are_refused(
    wrong: str, preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(tmp_path / "run")]
    refused(capsys, "--preset", str(preset), *OPTIONS[wrong], *out)
    assert main(["train", "--preset", str(preset), "--steps", "1", *out]) == 0  # the folder is still free


CHANGES = {
    "no TOML": ("gate = 0.9", "gate = "),
    "no section": ("[rewards]\ngoal = 1.0", ""),
    "no entry": ("cap = 2", ""),
    "unknown entry": ("cap = 2", "cap = 2\ncup = 3"),
    "unknown reward": ("goal = 1.0", "gaol = 1.0"),
    "a reward that is none": ("goal = 1.0", "goal = nan"),
    "a share above 1": ("gate = 0.9", "gate = 7"),
    "a discount above 1": ("[ppo]", "[ppo]\nlam = 3.0"),
    "a rate below 0": ("[ppo]", "[ppo]\nclip_param = -1.0"),
    "a later number out of its range": ("[rewards]", "[[later]]\nfrom_steps = 9\nppo = { gamma = 3.0 }\n[rewards]"),
    "a text for a list": ("hidden = [8]", 'hidden = "big"'),
    "no share": ("gate = 0.9\n", ""),
    "unknown flip": ('flip = "rows"', 'flip = "columns"'),
    "unknown distribution": ('"TanhNormal"', '"Cauchy"'),
    "unknown player": ("still = 1", "stil = 1"),
    "unknown part of PPO": ("gamma = 0.95", "gamma = 0.95\nlambda = 0.5"),
    "no gamma": ("gamma = 0.95", ""),
    "tables that do not suffice": ("earlier = [1]", "earlier = [9]"),
    "tables no number": ("tables = 4", 'tables = "many"'),
    "steps no number": ("steps = 2", 'steps = "two"'),
    "steps 0": ("steps = 2", "steps = 0"),
    "round 0": ("round = 1", "round = 0"),
    "hidden words": ("hidden = [8]", 'hidden = ["8"]'),
    "an unknown change": ("[rewards]", "[[later]]\nfrom_steps = 9\nppo = { epochs = 1 }\n[rewards]"),
    "a change of no reward": ("[rewards]", "[[later]]\nfrom_steps = 9\nrewards = { gaol = 1.0 }\n[rewards]"),
    "a change by words": ("[rewards]", "[[later]]\nfrom_steps = 9\nrewards = { goal = 'much' }\n[rewards]"),
    "a change at no step": ("[rewards]", "[[later]]\nppo = { gamma = 0.9 }\n[rewards]"),
    "a section that is a number": ("[league]", "league = 3\n[other]"),
    "anchors in a list": ("anchors = {", "anchors = ['still']\nwere = {"),
    "a gate of words": ("gate = 0.9", "gate = 'high'"),
    "a rate of words": ("gamma = 0.95", "gamma = 0.95\nlearning_rate = 'fast'"),
    "rewards of words": ("goal = 1.0", "goal = 'much'"),
    "no batches": ("num_mini_batches = 1", "num_mini_batches = 0"),
    "a flip that the critic contradicts": (
        'flip = "rows"\n[network]',
        'flip = "augment"\n[network]\ncritic = "state"',
    ),
}


@pytest.mark.parametrize("wrong", CHANGES)
def test_invalid_presets_are_refused(
    wrong: str, preset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, after = CHANGES[wrong]
    assert before in TINY
    preset.write_text(TINY.replace(before, after))
    out = ["--out", str(tmp_path / "run"), "--preset", str(preset), "--steps", "1"]
    refused(capsys, *out)
    preset.write_text(TINY)
    assert main(["train", *out]) == 0  # the folder is still free
