"""The camera's map from image to table is stretched or sheared about the origin."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a calibration by a few marks: up to a percent or two"

EFFECT = Effect(
    regime="sensing",
    law="seen x = (1 + scale_x) x + shear y, seen y = (1 + scale_y) y",
    rows={
        "scale_x": Parameter("camera_scale_x", "1", 0.0, -0.05, 0.05, "by how much more is seen along x", _SOURCE),
        "scale_y": Parameter("camera_scale_y", "1", 0.0, -0.05, 0.05, "by how much more is seen along y", _SOURCE),
        "shear": Parameter("camera_shear", "1", 0.0, -0.05, 0.05, "how far along x a place is seen for its y", _SOURCE),
    },
    depends_on=("position",),
    excited_by="hits of all four walls (a shear: of the long ones), and the table's true size",
    source="the linear part of any smooth map",
)


@kernel
def camera_map(p):
    """Error of the seen x by x and by y, and of the seen y by x and by y."""
    return p.camera_scale_x, p.camera_shear, 0.0, p.camera_scale_y
