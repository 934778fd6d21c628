"""A camera's map whose stretch along one axis is undetermined, and an anisotropy of friction that looks the same."""

from __future__ import annotations

from dataclasses import replace

from sim2real.diagnose.regimes.sensing.tuned import SCALE
from sim2real.diagnose.result.result import RegimeResult

ANISOTROPY = "friction_anisotropy"
SCALES = {"scale_x": "x", "scale_y": "y"}


def without_stretch(glides: RegimeResult, sensing: RegimeResult) -> RegimeResult:
    """The result of the glides without an anisotropy of friction that a stretch of the map explains.

    Through a camera that stretches x by s, friction along x is (1 + s) times that along y: a grain of s / 2. It applies
    only where the map is stretched along one axis and the walls do not determine the other; no stretch beyond
    `SCALE.most_scale` is taken for the camera's.
    """
    stretch = next((one for one in sensing.findings if one.mechanism == "scale_error"), None)
    anisotropy = next((one for one in glides.findings if one.mechanism == ANISOTROPY), None)
    if stretch is None or anisotropy is None:
        return glides
    unknown = [axis for name, axis in SCALES.items() if name not in stretch.parameters]
    if not unknown or abs(anisotropy.parameters["grain"].value) > SCALE.most_scale / 2.0:
        return glides
    axes = " and ".join(unknown)
    return replace(
        glides,
        findings=tuple(one for one in glides.findings if one is not anisotropy),
        doubt=f"{ANISOTROPY} would fit, but so would a map stretched along {axes}, which these bounces do not tell",
    )
