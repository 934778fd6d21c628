"""Where tests find the repository, and the shared recordings beside it."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHARED = ROOT.parent / "shared" / "recordings"
PRACTICE, UBC = SHARED / "practice", SHARED / "ubc"
