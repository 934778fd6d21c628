"""The version of the code that kept results come from, so that results of other versions are not reused."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

OF_STUDIES = ("sim2real", "puckpilot_env")  # the diagnosis, its physics, and the independent table
# The players, the board's program, and all that plays at a table; not what learns from it, such as the diagnosis
OF_GAMES = (
    "agents", "baselines", "firmware", "puckpilot_env", "sim2real/camera", "sim2real/emulate", "sim2real/link",
    "sim2real/recording", "sim2real/statistics", "sim2real/study/independent_table", "sim2real/table",
    "sim2real/vision",
)  # fmt: skip
ENDINGS = (".py", ".elf", ".npz")  # code, the board's program, trained players


def code_version(root: Path, folders: Sequence[str]) -> str:
    """A short digest of the code in `folders` of the checkout `root`."""
    digest = hashlib.sha256()
    for folder in folders:
        for file in sorted(one for one in (root / folder).rglob("*") if one.suffix in ENDINGS):
            text = file.read_bytes()
            digest.update(f"{file.relative_to(root).as_posix()} {len(text)}\n".encode() + text)
    return digest.hexdigest()[:12]
