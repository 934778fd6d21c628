"""Go through the steps of a bring-up, until one does not pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from sim2real.table.bring_up.rig import Rig
from sim2real.table.bring_up.steps import STEPS


@dataclass(frozen=True)
class StepResult:
    """A step by name, whether it passed, and in one line what was seen, or what to mend."""

    name: str
    passed: bool
    text: str


def run_steps(rig: Rig, report: Callable[[StepResult], None]) -> bool:
    """Go through all steps, the table's parts opened before and closed after; whether all passed. `report` takes each
    result as it comes; after one that did not pass no other is tried."""
    try:
        for name, step in (("open", _open), *((step.__name__, step) for step in STEPS)):
            try:
                report(StepResult(name, True, step(rig)))
            except ValueError as error:
                report(StepResult(name, False, str(error).removesuffix("; then clear")))  # which is for a game
                return False
        return True
    finally:
        rig.table.close()


def _open(rig: Rig) -> str:
    rig.table.open(rig.home)
    rig.table.check_camera()
    return "port and camera are open, and the camera's place is found in its pictures"
