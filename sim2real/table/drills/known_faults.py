"""The faults that can happen at a twin, by its camera."""

from __future__ import annotations

from sim2real.table.drills.faults import FAULTS, Fault
from sim2real.table.drills.picture_faults import PICTURE_FAULTS

BY_CAMERA: dict[str, tuple[Fault, ...]] = {"places": FAULTS, "pictures": (*FAULTS, *PICTURE_FAULTS)}
BY_NAME = {fault.name: fault for fault in BY_CAMERA["pictures"]}
