"""What a backend observes and takes is stated before anything is connected, and is what readings and plans hold."""

from __future__ import annotations

from dataclasses import fields

from sim2real.table.backend import Backend, SeenFrame, SeenMallet
from sim2real.table.mallet_driver import MalletPlan


def test_what_is_stated_is_what_there_is() -> None:
    parts = {"frames": SeenFrame, "mallets": SeenMallet}
    assert set(Backend.observes) == {f"{part}.{field.name}" for part, kind in parts.items() for field in fields(kind)}
    assert set(Backend.takes) == {field.name for field in fields(MalletPlan)}
