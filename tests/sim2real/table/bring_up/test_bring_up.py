"""The bring-up at the twin: all steps pass, and what is wrong is named by the step that looks at it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.table.bring_up.rig import Rig
from sim2real.table.bring_up.run import StepResult, run_steps
from sim2real.table.game.game_record import GameRecord
from sim2real.table.twin.camera import CameraErrors
from sim2real.table.twin.twin import Twin

STEPS = ["open", "link", "encoders", "homing", "power", "limits", "stop", "camera", "light", "film", "latency"]


def checked(spoil: Callable[[Twin], None] = lambda twin: None, **options: object) -> list[StepResult]:
    game = GameRecord("puckpilot/match-v0")
    twin = Twin(game, "still", **options)  # pyright: ignore[reportArgumentType] - options by name
    opened, results = twin.open, []

    def open_and_spoil(home: tuple[float, float]) -> None:
        opened(home)
        spoil(twin)

    twin.open = open_and_spoil
    run_steps(Rig(twin, game, (0.25, 0.5)), results.append)
    assert twin.board is None  # closed
    return results


@pytest.mark.slow
def test_a_sound_table_passes_all_steps() -> None:
    results = checked()
    assert [result.name for result in results if result.passed] == STEPS


def motors_off(twin: Twin) -> None:
    twin.plant.drive = lambda first, second: None


def no_frames(twin: Twin) -> None:
    twin.camera.unplugged = True


def no_answers(twin: Twin) -> None:
    assert twin.board is not None
    twin.board.cut = True


def late_word_of_a_stop(twin: Twin) -> None:
    stop = twin.stop

    def stop_and_hear_late() -> None:
        stop()
        twin.pass_time(twin.now() + 0.05)

    twin.stop = stop_and_hear_late


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spoil", "options", "step", "words"),
    [
        (no_answers, {}, "link", "no board answers"),
        (motors_off, {}, "power", "the board stopped the motors|is the motors' supply on"),
        (no_frames, {}, "power", "no frame for"),
        (late_word_of_a_stop, {}, "stop", "confirmed .. ms after it was asked for, expected 60 ms or less; check"),
        (lambda twin: None, {"errors": CameraErrors(noise=0.002)}, "film", "a scatter of . mm|a scatter of ...."),
    ],
)
def test_what_is_wrong_is_named_by_its_step(spoil: Callable, options: dict, step: str, words: str) -> None:
    result = checked(spoil, **options)[-1]
    assert (result.name, result.passed) == (step, False)
    import re

    assert re.search(words, result.text), result.text
