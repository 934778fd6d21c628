"""What the simulator says about each piece of a recording, and how far the piece is from it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from puckpilot_env.physics import bounce, contact, glide
from sim2real.diagnose.hits import Hit
from sim2real.diagnose.pieces import Glide, Pieces
from sim2real.diagnose.sensor import Noise

FITTED_PART = 0.4
FEWEST_FRAMES = 24
SLOWEST = 0.05
UNEXPLAINED = "unexplained events"


@dataclass(frozen=True)
class GlideError:
    """A glide against its prediction, from a start fitted to its first part (`fitted` frames) with the same law.

    `t` (n,) [s] since the start, `x`, `y` (n,) [m] seen, `error` (n, 2) [m] along and across the motion, seen less
    predicted; `std` (n, 2) [m] is what the sensor's noise alone would make of it, the fitted start's share included.
    """

    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    error: np.ndarray
    std: np.ndarray
    fitted: int
    speed: float


@dataclass(frozen=True)
class HitError:
    """A hit against its prediction; velocities (2,) [m/s] split along the normal and the tangent."""

    hit: Hit
    before: np.ndarray
    after: np.ndarray
    predicted: np.ndarray

    @property
    def error(self) -> np.ndarray:
        return self.after - self.predicted


@dataclass(frozen=True)
class Comparison:
    """All pieces that could be compared, and for each kind why others could not (reason -> count)."""

    glides: tuple[GlideError, ...]
    walls: tuple[HitError, ...]
    mallets: tuple[HitError, ...]
    unusable: dict[str, Counter]


def compare_pieces(pieces: Pieces, values: dict[str, float]) -> Comparison:
    """Predict every usable piece with the parameters `values`."""
    unusable: dict[str, Counter] = {"glide": Counter(), "wall": Counter(), "mallet": Counter(), "other": Counter()}
    glides = []
    for piece in pieces.glides:
        reason = _why_no_glide(piece)
        if reason:
            unusable["glide"][reason] += 1
        else:
            glides.append(predict_glide(piece, pieces.noise, values["friction"], values["drag"]))
    walls, mallets = [], []
    for hit in pieces.hits:
        if hit.kind not in ("wall", "mallet"):
            name = UNEXPLAINED if hit.kind == "unexplained" else "goal post hits, not compared"
            unusable["other"][name] += 1
        elif not hit.clean:
            unusable[hit.kind]["too few frames beside another event"] += 1
        elif hit.kind == "wall":
            walls.append(predict_wall(hit, values["wall_restitution"]))
        elif not np.isfinite(hit.mallet_v).all():
            unusable["mallet"]["mallet not seen"] += 1
        else:
            mallets.append(predict_mallet(hit, values["mallet_restitution"]))
    return Comparison(tuple(glides), tuple(walls), tuple(mallets), unusable)


def _why_no_glide(piece: Glide) -> str:
    if len(piece.t) < FEWEST_FRAMES:
        return f"shorter than {FEWEST_FRAMES} frames"
    speed = float(np.hypot(piece.x[-1] - piece.x[0], piece.y[-1] - piece.y[0])) / (piece.t[-1] - piece.t[0])
    return f"slower than {SLOWEST} m/s" if speed < SLOWEST else ""


def predict_glide(piece: Glide, noise: Noise, friction: float, drag: float) -> GlideError:
    """Fit place and velocity of the start to the first FITTED_PART of the glide, then follow the law to its end."""
    t, seen = piece.t - piece.t[0], np.stack([piece.x, piece.y], axis=1)
    fitted = max(8, int(FITTED_PART * len(t)))
    p0, v0 = piece.entry.place, piece.entry.velocity
    for _ in range(4):
        path, along, slopes = _law(t, p0, v0, friction, drag)
        across = np.array([-along[1], along[0]])
        rest = (seen - path) @ np.stack([along, across], axis=1)
        # along: d/dp = 1, d/dv = ds/dv; across: d/dp = 1, d/dv = s/v
        solved = [np.linalg.lstsq(_design(slopes[:fitted, k]), rest[:fitted, k], rcond=None)[0] for k in (0, 1)]
        p0 = p0 + solved[0][0] * along + solved[1][0] * across
        v0 = v0 + solved[0][1] * along + solved[1][1] * across
    path, along, slopes = _law(t, p0, v0, friction, drag)
    axes = np.stack([along, [-along[1], along[0]]], axis=1)
    speed = float(np.linalg.norm(v0))
    sigma = noise.std(np.array([speed, 0.0]))
    std = np.stack([_spread(slopes[:, k], fitted, sigma[k]) for k in (0, 1)], axis=1)
    return GlideError(t, piece.x, piece.y, (seen - path) @ axes, std, fitted, speed)


def _law(t, p0, v0, friction: float, drag: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Path (n, 2) of the simulator, its direction (2,), and d(place)/d(velocity) along and across, (n, 2) [s]."""
    speed = max(float(np.linalg.norm(v0)), 1e-6)
    along = v0 / speed
    step = 1e-4 * speed
    s = np.array([glide.distance(speed, float(at), friction, drag) for at in t])
    more = np.array([glide.distance(speed + step, float(at), friction, drag) for at in t])
    return p0 + s[:, None] * along, along, np.stack([(more - s) / step, s / speed], axis=1)


def _design(slope: np.ndarray) -> np.ndarray:
    return np.stack([np.ones_like(slope), slope], axis=1)


def _spread(slope: np.ndarray, fitted: int, sigma: float) -> np.ndarray:
    """Std (n,) of seen less predicted under white noise `sigma`, for a start fitted to the first `fitted` frames."""
    design = _design(slope)
    cover = np.linalg.pinv(design[:fitted].T @ design[:fitted])
    share = np.einsum("ni,ij,nj->n", design, cover, design)
    return sigma * np.sqrt(1.0 + np.where(np.arange(len(slope)) < fitted, -share, share).clip(-0.99))


def predict_wall(hit: Hit, restitution: float) -> HitError:
    """The velocity after a wall, from that before it."""
    after = bounce.reflect(*map(float, hit.v_in), *map(float, hit.normal), restitution)
    return _split(hit, hit.v_in, hit.v_out, np.array(after))


def predict_mallet(hit: Hit, restitution: float) -> HitError:
    """The velocity after a mallet, from those of puck and mallet; all relative to the mallet."""
    given = (*hit.v_in, *hit.mallet_v, *hit.normal)
    after = np.array(contact.reflect(*map(float, given), restitution))
    return _split(hit, hit.v_in - hit.mallet_v, hit.v_out - hit.mallet_v, after - hit.mallet_v)


def _split(hit: Hit, before: np.ndarray, after: np.ndarray, predicted: np.ndarray) -> HitError:
    axes = np.stack([hit.normal, [-hit.normal[1], hit.normal[0]]])
    return HitError(hit, axes @ before, axes @ after, axes @ predicted)
