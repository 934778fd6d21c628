"""Summarise a comparison: number of segments, prediction errors, and the kind of segment with the largest error."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sim2real.compare.contacts import ContactError
from sim2real.compare.glides import GlideError
from sim2real.compare.predict import UNEXPLAINED, Comparison
from sim2real.compare.tuned import COMPARISON
from sim2real.diagnose.input_checks import notes
from sim2real.diagnose.regimes.sensing.repeated_frames import repeats_while_moving
from sim2real.recording.folder import Recording
from sim2real.segmentation.segments import Segments


def summarize(recording: Recording, segments: Segments, found: Comparison, values: dict[str, float]) -> dict[str, Any]:
    """Summarise the comparison `found` of `segments` with the parameters `values`, by name, as a JSON-ready object.

    Errors are in metres and m/s; `times_noise` is the rms in units of its standard deviation under noise alone.
    """
    seen = 0 if recording.frames is None else int(np.isfinite(recording.frames["puck_x"]).sum())
    summary = {
        "recording": recording.name,
        "notes": [*notes([recording]), *_remarks(recording, seen, found)],
        "parameters": {name: values[name] for name in ("friction", "drag", "wall_restitution", "mallet_restitution")},
        "kept_by_simulator": {
            "wall": dict.fromkeys(("restitution_normal", "restitution_tangential"), values["wall_restitution"]),
            "mallet": {"restitution_normal": values["mallet_restitution"], "restitution_tangential": 1.0},
        },
        "sensor": {
            "frames": 0 if recording.frames is None else recording.frames.rows,
            "seen": seen,
            "held": repeats_while_moving(recording, segments),
            "wild": int(segments.wild.sum()),
            "position_std_m": segments.noise.position if seen else None,
            "clock_std_s": segments.noise.clock if seen else None,
            "launches": len(segments.launches),
        },
        "glide": _glides(found.glides),
        "wall": _contacts(found.walls),
        "mallet": _contacts(found.mallets),
        "unusable": {kind: dict(reasons) for kind, reasons in found.unusable.items() if reasons},
    }
    return summary | {"part_most": _largest_difference(summary)}


def _remarks(recording: Recording, seen: int, found: Comparison) -> Iterator[str]:
    """Sentences on limitations of the numbers; `seen`: number of frames with a puck."""
    if not seen:
        if recording.mallet is not None and recording.mallet.rows:
            yield "only the gantry was recorded: run puckpilot diagnose to compare its motion with the simulator's"
        return
    counts = {"glide": len(found.glides), "wall": len(found.walls), "mallet": len(found.mallets)}
    few = [f"{count} of {kind}" for kind, count in counts.items() if 0 < count < COMPARISON.few]
    if few:
        yield f"medians of fewer than {COMPARISON.few} segments are unreliable ({', '.join(few)}); record longer"
    unexplained = found.unusable["other"][UNEXPLAINED]
    changes = counts["wall"] + counts["mallet"] + unexplained
    if unexplained > COMPARISON.many * changes:
        yield (
            f"{unexplained} of {changes} changes of motion are unexplained; check for hands or objects on the table, "
            "and for wrong sizes in meta.json"
        )


def range_of(values: np.ndarray) -> dict[str, float] | None:
    """Median of `values` (n,) and the range of the middle 90 %; None if there are none."""
    if len(values) == 0:
        return None
    low, middle, high = np.quantile(values, [0.05, 0.5, 0.95])
    return {"median": float(middle), "low": float(low), "high": float(high)}


def _glides(glides: tuple[GlideError, ...]) -> dict[str, Any]:
    """The numbers of the glides: errors after the part that the start was fitted to."""
    if not glides:
        return {"pieces": 0}
    ahead = [(g.error[g.fitted :], g.std[g.fitted :], g.t[g.fitted :] - g.t[g.fitted - 1]) for g in glides]
    ends = np.array([np.hypot(*error[-1]) for error, _, _ in ahead])
    ratio = np.array([np.sqrt(np.mean((error / std) ** 2)) for error, std, _ in ahead])
    along = np.array([error[-1, 0] for error, _, _ in ahead])
    error, std, t = (np.concatenate(part) for part in zip(*ahead, strict=True))
    return {
        "pieces": len(glides),
        "seconds": float(sum(g.t[-1] for g in glides)),
        "end_error_m": range_of(ends),
        "end_error_along_m": range_of(along),
        "rms_m": float(np.sqrt(np.mean(np.sum(error**2, axis=1)))),
        "times_noise": range_of(ratio),
        "growth": _growth(error, std, t),
    }


def _growth(error: np.ndarray, std: np.ndarray, t: np.ndarray) -> list[dict[str, float]]:
    """Errors (n, 2) [m] with standard deviation `std` (n, 2), by the time `t` (n,) [s] since the fitted part."""
    rows = []
    for low, high in zip((0.0, *COMPARISON.growth[:-1]), COMPARISON.growth, strict=True):
        here = (t > low) & (t <= high)
        if here.sum() >= 10:
            rms = float(np.sqrt(np.mean(np.sum(error[here] ** 2, axis=1))))
            ratio = float(np.sqrt(np.mean((error[here] / std[here]) ** 2)))
            rows.append({"ahead_s": high, "rms_m": rms, "times_noise": ratio, "frames": int(here.sum())})
    return rows


def _contacts(contacts: tuple[ContactError, ...]) -> dict[str, Any]:
    """The numbers of the contacts of one kind: errors, and ratios of speed kept."""
    if not contacts:
        return {"pieces": 0}
    before, after = np.array([h.before for h in contacts]), np.array([h.after for h in contacts])
    error, std = np.array([h.error for h in contacts]), np.array([h.std for h in contacts])
    closing = before[:, 0] < -COMPARISON.clear_speed
    sliding = np.abs(before[:, 1]) > COMPARISON.clear_speed
    return {
        "pieces": len(contacts),
        "speed_before": range_of(np.linalg.norm(before, axis=1)),
        "error_mps": range_of(np.linalg.norm(error, axis=1)),
        "error_normal_mps": range_of(error[:, 0]),
        "error_tangential_mps": range_of(error[:, 1] * np.sign(before[:, 1])),
        "restitution_normal": range_of(-after[closing, 0] / before[closing, 0]),
        "restitution_tangential": range_of(after[sliding, 1] / before[sliding, 1]),
        "times_noise": range_of(np.sqrt(np.mean((error / std) ** 2, axis=1))),
    }


def _largest_difference(summary: dict[str, Any]) -> str:
    """A sentence on the kind of segment on which simulator and recording differ most, in units of noise."""
    ratios = {
        kind: summary[kind]["times_noise"]["median"] for kind in ("glide", "wall", "mallet") if summary[kind]["pieces"]
    }
    if not ratios:
        return "unknown: the recording has no usable free motion of the puck"
    kind = max(ratios, key=lambda name: ratios[name])
    if ratios[kind] < COMPARISON.agrees:
        return f"none beyond noise: the largest is {kind} with {ratios[kind]:.1f} times the noise"
    return f"{_words(kind, summary[kind])}; that is {ratios[kind]:.1f} times the noise"


def _words(kind: str, part: dict[str, Any]) -> str:
    """The difference on the segments of a kind, in words."""
    if kind == "glide":
        along = part["end_error_along_m"]["median"]
        way = "further" if along > 0 else "less far"
        return (
            f"glides: at the end of a glide the prediction error is {1e3 * part['end_error_m']['median']:.1f} mm "
            f"(median of {part['pieces']}); the puck is {1e3 * abs(along):.1f} mm {way} along its path than predicted"
        )
    normal, tangential = part["restitution_normal"], part["restitution_tangential"]
    kept = [
        f"{range_['median']:.2f} {name}" for range_, name in ((normal, "normal"), (tangential, "tangential")) if range_
    ]
    return (
        f"{kind} contacts: the error of the velocity after them is {part['error_mps']['median']:.2f} m/s (median of "
        f"{part['pieces']}); the ratio kept is {', '.join(kept) or 'unknown'}"
    )
