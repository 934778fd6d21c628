"""Reject a friction anisotropy that an undetermined stretch of the camera's map explains as well."""

from __future__ import annotations

from dataclasses import replace

from sim2real.diagnose.regimes.sensing.tuned import SCALE
from sim2real.diagnose.result.result import RegimeResult

ANISOTROPY = "friction_anisotropy"
SCALES = {"scale_x": "x", "scale_y": "y"}


def without_stretch(glides: RegimeResult, sensing: RegimeResult) -> RegimeResult:
    """Remove a friction anisotropy from the result of the glides if a stretch of the map explains it.

    If the camera stretches x by s, friction along x appears (1 + s) times that along y, a grain of s / 2. The
    anisotropy is removed only if the map is stretched along one axis, the walls do not determine the other axis, and
    the stretch is at most `SCALE.most_scale`. The fitted model keeps the law, since the paths bend either way: contacts
    are extrapolated with it, and the proof is that of the model.
    """
    stretch = next((one for one in sensing.findings if one.mechanism == "scale_error"), None)
    anisotropy = next((one for one in glides.findings if one.mechanism == ANISOTROPY), None)
    if stretch is None or anisotropy is None:
        return glides
    unknown = [axis for name, axis in SCALES.items() if name not in stretch.parameters]
    if not unknown or abs(anisotropy.parameters["grain"].value) > SCALE.most_scale / 2.0:
        return glides
    axes = " and ".join(unknown)
    doubt = f"{ANISOTROPY} fits, but so does a map stretched along {axes}, which these bounces do not determine"
    return replace(
        glides,
        findings=tuple(one for one in glides.findings if one is not anisotropy),
        doubt="; ".join(filter(None, (glides.doubt, doubt))),
    )
