"""The whole circle: play, diagnose, fine-tune, play again, in stages, each of which keeps what it made in the circle's
folder and is not run again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from sim2real.gap.circle_folder import (
    CircleFolder,
    Conditions,
    keep_conditions,
    keep_training,
    refuse_other,
    refuse_other_training,
)
from sim2real.gap.stages import FIRST, STAGES, Progress, Report, Work


class Circle:
    """A circle in its folder. processes: that play or learn at once; report: takes a line for each stage that begins;
    shared: folder of arms that learn the same for every table, None for the circle's."""

    def __init__(
        self, folder: Path, conditions: Conditions, processes: int, report: Report, shared: Path | None = None
    ) -> None:
        self.folder, self._processes, self._report = CircleFolder(folder, conditions, shared), processes, report
        refuse_other(folder, conditions)
        if shared:
            refuse_other_training(shared, conditions)

    def run(self, arms: list[str], progress: Progress) -> dict[str, Any]:
        """All stages that are not done yet; the result, as it is written to gap.json."""
        for stage in STAGES:
            self.run_stage(stage, arms, progress)
        return self.kept()

    def run_stage(self, stage: str, arms: list[str], progress: Progress) -> None:
        """One of `stages.STAGES` alone. ValueError, in one line, where an earlier one has to be run first."""
        if stage == FIRST:
            self._keep()
        STAGES[stage](Work(self.folder, arms, self._processes, self._report, progress))
        self._keep()  # not before: a stage that is refused leaves nothing behind

    def _keep(self) -> None:
        keep_conditions(self.folder.path, self.folder.conditions)
        if self.folder.shared:
            keep_training(self.folder.shared, self.folder.conditions)

    def kept(self) -> dict[str, Any]:
        """The result that the last stage wrote."""
        return json.loads((self.folder.path / "gap.json").read_text(encoding="utf-8"))
