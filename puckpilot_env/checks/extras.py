"""Pictures and pickles, for environments that have them."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np

from puckpilot_env.checks.compare import difference
from puckpilot_env.checks.result import INFO, WARNING, Check, Fault, Subject, describe
from puckpilot_env.checks.seeding import require_reproducible
from puckpilot_env.checks.walk import begin, follow, walk, walk_together

PICTURES = 20
STEPS = 300


def _make_rendering(subject: Subject) -> Any:
    try:
        return subject.make(render_mode="rgb_array")
    except TypeError:
        return subject.make()


def _renders(subject: Subject) -> str:
    if "rgb_array" not in (getattr(subject.make(), "metadata", {}).get("render_modes") or []):
        return "does not apply: metadata names no 'rgb_array'"
    env = _make_rendering(subject)
    if getattr(env, "render_mode", None) != "rgb_array":
        return "does not apply: it was made with another render_mode"
    shape = None
    for moment in walk(env, min(PICTURES, subject.steps), subject.seed):
        picture = env.render()
        if not isinstance(picture, np.ndarray) or picture.dtype != np.uint8:
            raise Fault(f"{moment.name}: render() gave {getattr(picture, 'dtype', type(picture).__name__)}, not uint8")
        if picture.ndim != 3 or picture.shape[2] != 3 or picture.shape != (shape or picture.shape):
            raise Fault(f"{moment.name}: the picture is {picture.shape}; expected {shape or '(height, width, 3)'}")
        shape = picture.shape
    env.close()
    return f"{shape} uint8 each time"


def _pickles(subject: Subject) -> str:
    """A copy made amid an episode has to play on like the original, into later episodes."""
    env = subject.make()
    moment = begin(env, subject.seed)
    for _ in range(3):
        moment = follow(env, moment)
    try:
        twin = pickle.loads(pickle.dumps(env))
    except Exception as error:
        raise Fault(f"cannot be pickled: {describe(error)}", INFO) from error
    steps = min(STEPS, subject.steps)
    require_reproducible(subject, steps)
    same = moment
    while moment.step < steps:
        moment = follow(env, moment)
        same = follow(twin, same, moment.actions)
        found = difference(moment.returned, same.returned)
        if found is not None:
            raise Fault(f"an unpickled copy plays on differently at {moment.name}: {found}", WARNING)
    for a, b in walk_together((env, twin), steps, subject.seed):
        found = difference(a.returned, b.returned)
        if found is not None:
            raise Fault(f"an unpickled copy, seeded anew, plays differently at {a.name}: {found}", WARNING)
    return f"a copy made amid an episode plays on the same for {steps:,} steps"


CHECKS = (
    Check(
        "pictures",
        "Videos can be made: render() always gives an RGB picture of one size.",
        "Return a (height, width, 3) uint8 array in render_mode 'rgb_array'.",
        _renders,
    ),
    Check(
        "pickles",
        "It can be sent to other processes, and copied amid an episode.",
        "Keep no threads, files or views of arrays in attributes, or write __getstate__ and __setstate__.",
        _pickles,
    ),
)
