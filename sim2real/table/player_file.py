"""Which player a name stood for when it played: the file of a policy may change, or move, while results are kept."""

from __future__ import annotations

import hashlib
from pathlib import Path

PREFIX, IN_RUN = "policy:", "policy.npz"


def player_digest(player: str) -> str:
    """A short digest of the file of a player that has one of its own; the name of any other, which the code has."""
    file = Path(player.removeprefix(PREFIX))
    file = file / IN_RUN if file.is_dir() else file
    return hashlib.sha256(file.read_bytes()).hexdigest()[:12] if file.is_file() else player
