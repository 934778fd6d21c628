"""A camera's map whose stretch along one axis nobody can tell, and a grain of friction that looks the same."""

from __future__ import annotations

from dataclasses import replace

from sim2real.diagnose.finding import Account
from sim2real.diagnose.sensing.scale import WRONG_SIZE

GRAIN = "friction_anisotropy"
SCALES = {"scale_x": "x", "scale_y": "y"}


def without_stretch(told: Account, sensing: Account) -> Account:
    """The account of the glides, but no grain is told that a stretch of the map can make.

    Seen by a camera that stretches x by s, friction along x is (1 + s) times that along y: a grain of s / 2. Asked only
    where the map is known to be stretched along one axis and the walls do not tell the other; no stretch beyond
    WRONG_SIZE is taken for the camera's.
    """
    stretch = next((one for one in sensing.findings if one.mechanism == "scale_error"), None)
    grain = next((one for one in told.findings if one.mechanism == GRAIN), None)
    if stretch is None or grain is None:
        return told
    unknown = [axis for name, axis in SCALES.items() if name not in stretch.parameters]
    if not unknown or abs(grain.parameters["grain"].value) > WRONG_SIZE / 2.0:
        return told
    axes = " and ".join(unknown)
    return replace(
        told,
        findings=tuple(one for one in told.findings if one is not grain),
        doubt=f"{GRAIN} would fit, but so would a map stretched along {axes}, which these bounces do not tell",
    )
