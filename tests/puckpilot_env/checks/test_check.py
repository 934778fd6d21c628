"""Every check catches what it is for and nothing else; upstream's tests let two of the broken environments pass."""

from __future__ import annotations

import argparse
import json

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test
from pettingzoo.test.example_envs import generated_agents_parallel_v0

from puckpilot_env.check import check_names, run_checks
from puckpilot_env.checks.compare import difference
from puckpilot_env.commands import check
from puckpilot_env.game import mirror
from tests.puckpilot_env.checks import broken

STEPS = 60
CAUGHT = {
    broken.Sound: set(),
    broken.RandomFromSecondStep: {"same seed, same game"},
    broken.RandomInfos: {"same seed, same game"},
    broken.LeavesSpaceAtStep30: {"observations in their space"},
    broken.WrongDtype: {"dtype and shape of the space"},
    broken.NewSpaces: {"spaces and agents stay"},
    broken.SpeaksOfOthers: {"keys are the live agents"},
    broken.NaNReward: {"rewards are finite numbers"},
    broken.NumpyFlags: {"flags are bools"},
    broken.AgentsStay: {"agents shrink and empty"},
    broken.GoesOnAfterTheEnd: {"refuses after the end"},
    broken.NoFinalObservation: {"final observations"},
    broken.FinalObservationIsNew: {"final observations"},
    broken.ReusedBuffer: {"kept arrays stay"},
    broken.SharedArrays: {"agents share no memory"},
    broken.WrittenBias: {"the caller may write"},
    broken.AcceptsNaN: {"bad actions are refused"},
    broken.BadActionLeavesTrace: {"bad actions are refused"},
    broken.GreyPictures: {"pictures"},
    broken.Breaks: {"plays"},
}


def failed(results):
    return {result.name for result in results if result.failed}


@pytest.mark.slow
@pytest.mark.parametrize("environment", CAUGHT, ids=lambda e: e.__name__)
def test_caught_by_its_check_alone(environment):
    """Every other check passes, or says that it cannot tell."""
    results = run_checks(environment, steps=STEPS)
    assert [result.name for result in results] == check_names()
    assert failed(results) == CAUGHT[environment]


def test_all_checks_have_a_broken_environment():
    """The three left are tested below: their findings are warnings, or the table itself has to be broken."""
    others = {"different seeds differ", "pickles", "turned table, same game", "turning is its own inverse"}
    assert set(check_names()) == set.union(*CAUGHT.values()) | others


def test_upstream_passes_two_of_them():
    """Why this check exists: `any(terminations1)` in upstream's loop asks the dict's keys, so it ends after a step."""
    parallel_seed_test(broken.RandomFromSecondStep)
    parallel_api_test(broken.LeavesSpaceAtStep30(), num_cycles=100)


def test_says_where():
    by_name = {result.name: result for result in run_checks(broken.LeavesSpaceAtStep30, steps=STEPS)}
    assert "step 30: observation of player_1[5] is 99" in by_name["observations in their space"].detail
    by_name = {result.name: result for result in run_checks(broken.RandomInfos, steps=STEPS)}
    assert "infos player_1 luck" in by_name["same seed, same game"].detail


@pytest.mark.parametrize(
    "environment, name, level",
    [
        (broken.DeafToSeeds, "different seeds differ", "warning"),
        (broken.CannotBePickled, "pickles", "info"),
        (broken.PartsWhenPickled, "pickles", "warning"),
    ],
)
def test_findings_that_fail_nothing(environment, name, level):
    results = run_checks(environment, steps=STEPS)
    assert failed(results) == set()
    assert [(r.name, r.level) for r in results if not r.passed] == [(name, level)]


def test_accepting_bad_actions_is_a_warning_without_the_claim(monkeypatch):
    monkeypatch.setattr(broken.AcceptsNaN, "metadata", {"render_modes": ["rgb_array"]})
    monkeypatch.setattr(broken.AcceptsNaN, "__setattr__", _keep_class_metadata)
    found = {result.name: result for result in run_checks(broken.AcceptsNaN, steps=STEPS)}["bad actions are refused"]
    assert not found.passed and found.level == "warning"
    assert found.detail == "NaN in the action of player_0 was accepted"


def _keep_class_metadata(self, name, value):
    if name != "metadata":
        object.__setattr__(self, name, value)


def without(field):
    """`turn_table` forgetting a field: still its own inverse, but another game."""

    def turn(tables, frames, length, width, right=mirror.turn_table):
        home = tables["puck"] if field == "turned" else tables
        kept = home[field].copy()
        right(tables, frames, length, width)
        home[field] = kept

    return turn


def sets_turned(tables, frames, length, width, right=mirror.turn_table):
    """`turn_table` that sets where it should change: right the first time only."""
    right(tables, frames, length, width)
    tables["puck"]["turned"] = 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "variant, turn, name",
    [
        ("match-v0", without("defending"), "turned table, same game"),
        ("match-v0", without("turned"), "turned table, same game"),  # shows in impulses and face-offs
        ("match-v0", without("score"), "turned table, same game"),
        ("match-randomized-v0", without("streams"), "turned table, same game"),
        ("defence-randomized-v0", without("subject"), "turned table, same game"),
        ("match-randomized-v0", without("camera"), "turned table, same game"),
        ("match-v0", sets_turned, "turning is its own inverse"),
    ],
)
def test_broken_mirrors(monkeypatch, variant, turn, name):
    monkeypatch.setattr(broken.Sound, "variant", variant)
    monkeypatch.setattr(mirror, "turn_table", turn)
    assert failed(run_checks(broken.Sound, steps=STEPS)) == {name}


def test_mirror_sees_every_situation():
    """The comparison is worth something only if goals, face-offs and endings happened in it."""
    found = {r.name: r for r in run_checks("match-v0", steps=200)}["turned table, same game"]
    counts = [int(word) for word in found.detail.replace(",", "").split() if word.isdigit()]
    assert len(counts) == 4 and min(counts[1:]) >= 20


def test_other_peoples_environment():
    """Upstream's example, in which agents come and go: it keeps most promises, and none of its findings is a crash."""
    results = {r.name: r for r in run_checks(generated_agents_parallel_v0.parallel_env, steps=60)}
    assert results["plays"].passed and results["observations in their space"].passed
    assert results["turned table, same game"].detail.startswith("does not apply")
    assert not any(result.detail.startswith("raised") for result in results.values())


def test_difference_is_bitwise():
    assert difference({"a": np.float32(np.nan)}, {"a": np.float32(np.nan)}) is None
    assert difference(0.0, -0.0) is not None
    assert difference(1, 1.0, "x") == "x is int and float"
    assert difference([np.zeros(2)], [np.array([0.0, 5e-324])], "x") == "x[0][1] is 0.0 and 5e-324"
    assert difference({"a": (1, "b")}, {"a": (1, "c")}, "x") == "x a[1] is 'b' and 'c'"


def command(*words):
    parser = argparse.ArgumentParser()
    check.add_arguments(parser)
    return check.run(parser.parse_args(words))


def test_command_in_json_and_exit_codes(capsys):
    assert command("tests.puckpilot_env.checks.broken:Sound", "--steps", "60", "--json") == 0
    (report,) = json.loads(capsys.readouterr().out)
    assert [finding["name"] for finding in report["checks"]] == check_names()
    assert all(finding["passed"] for finding in report["checks"])
    assert command("tests.puckpilot_env.checks.broken:WrongDtype", "--steps", "60") == 1
    printed = capsys.readouterr().out
    assert "float64" in printed and "19 of 20 passed, 1 failed" in printed


@pytest.mark.parametrize(
    "name, words",
    [
        ("match-v", "unknown environment 'match-v'; did you mean 'puckpilot/match-v0'?"),
        ("chess", "unknown environment 'chess'; expected an id of the registry or \"module:attribute\""),
        ("nowhere.at.all:env", "cannot import 'nowhere.at.all:env': ModuleNotFoundError: No module named 'nowhere'"),
        ("puckpilot_env.match_v0:ENV", "cannot import 'puckpilot_env.match_v0:ENV': .*ENV"),
        ("puckpilot_env.match_v0:VARIANT", "'puckpilot_env.match_v0:VARIANT' is a Variant; expected something"),
        ("puckpilot_env.match_v0:env", "expected a pettingzoo.ParallelEnv; pettingzoo.utils.aec_to_parallel"),
        (
            "puckpilot_env.adapters.parallel_env:TableEnv",
            "cannot make 'puckpilot_env.adapters.parallel_env:TableEnv': TypeError",
        ),
    ],
)
def test_command_says_what_it_could_not_do(name, words):
    with pytest.raises(ValueError, match=words.replace("?", r"\?")) as output:
        command(name, "--steps", "60")
    assert "\n" not in str(output.value)


def test_too_few_steps():
    with pytest.raises(ValueError, match="steps is 1; expected at least 2"):
        command("match-v0", "--steps", "1")
