"""What the page of a recording draws: what was seen, and what the simulator says of each piece of it."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim2real.arena.recordings.found import read_diagnosis
from sim2real.compare.contacts import ContactError
from sim2real.compare.glides import GlideError
from sim2real.compare.predict import compare_segments
from sim2real.recording.folder import Recording, read_recording
from sim2real.recording.stream_csv import Stream
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.segments import segment

SIZES = ("length", "width", "goal_width", "puck_radius", "mallet_radius")


def replay_of(folder: Path) -> str:
    """A recording for the page, as JSON. RecordingError, in one line, if it cannot be read."""
    recording = read_recording(folder).from_zero()
    values = parameters(recording)
    content = {
        "name": recording.name,
        "note": str(recording.meta.get("note") or ""),
        "table": {name: values[name] for name in SIZES},
        "puck": _track(recording.frames, "puck"),
        "mallets": [_track(recording.mallet, "mallet"), _track(recording.frames, "opponent")],
        **_predictions(recording, values),
    }
    return json.dumps(content, separators=(",", ":"), allow_nan=False)


def diagnosed_replay_of(folder: Path, diagnosis: Path) -> str:
    """What a diagnosis found in a recording, and the predictions with that in place of those of `replay_of`, as JSON.
    RecordingError or ValueError, in one line, if either cannot be read."""
    recording, found = read_recording(folder).from_zero(), read_diagnosis(diagnosis)
    content = {
        "summary": found.summary,
        "left_out": found.left_out,
        **_predictions(recording, parameters(recording, found.values)),
    }
    return json.dumps(content, separators=(",", ":"), allow_nan=False)


def _predictions(recording: Recording, values: dict[str, float]) -> dict[str, Any]:
    """The glides and contacts of a recording with their predictions by the simulator with these parameters."""
    segments = segment(recording)
    found = compare_segments(recording, segments, values)
    compared = {id(one.contact): one for one in (*found.walls, *found.mallets)}
    rubs = values["wall_mu"] > 0.0 or values["mallet_mu"] > 0.0
    contacts = [
        {"t": round(one.t, 4), "place": _rounded([one.x, one.y]), "kind": one.kind, "where": one.where}
        | _velocities(compared.get(id(one)), rubs)
        for one in segments.contacts
    ]
    return {"glides": [_glide(glide) for glide in found.glides], "contacts": contacts}


def _track(stream: Stream | None, what: str) -> dict[str, Any]:
    """Times [s] and places [m] of what was seen, null where it was not."""
    if stream is None:
        return {"t": [], "place": []}
    places = np.column_stack([stream[f"{what}_x"], stream[f"{what}_y"]])
    return {"t": _rounded(stream.t), "place": [None if np.isnan(at).any() else _rounded(at) for at in places]}


def _glide(glide: GlideError) -> dict[str, Any]:
    """A glide and its prediction, which follows the first `fitted` frames; distances in millimetres."""
    return {
        "t": _rounded(glide.begins + glide.t),
        "path": [_rounded(place) for place in glide.path],
        "fitted": glide.fitted,
        "off_mm": [round(1e3 * float(off), 2) for off in np.hypot(*glide.error.T)],
        "noise_mm": [round(1e3 * float(off), 2) for off in np.hypot(*glide.std.T)],
    }


def _velocities(error: ContactError | None, rubs: bool) -> dict[str, Any]:
    """Velocities [m/s] along the normal and the tangent, if the contact could be compared; and whether the prediction
    hangs on a spin that is not known, where walls or mallets rub."""
    if error is None:
        return {}
    rows = {"before": error.before, "after": error.after, "predicted": error.predicted, "std": error.std}
    velocities = {name: [round(float(v), 3) for v in row] for name, row in rows.items()}
    return {**velocities, "guessed": rubs and not error.spin.known}


def _rounded(numbers: Any) -> list[float]:
    """To a tenth of a millimetre, or of a millisecond."""
    values: NDArray[np.float64] = np.asarray(numbers, float)
    return [round(float(value), 4) for value in values]


def main() -> int:
    """Print the recording that is named, or what the diagnosis named after it makes of it, for the server's process. 2:
    it cannot be read, and one line says why."""
    folder, *diagnosis = map(Path, sys.argv[1:])
    try:
        print(diagnosed_replay_of(folder, diagnosis[0]) if diagnosis else replay_of(folder))
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
