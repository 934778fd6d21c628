"""Compare contacts with the simulator: velocity after a contact, predicted from the one before, with uncertainty."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.contacts.rebound import rebound, strike
from sim2real.compare.map_error import MapError
from sim2real.diagnose.regimes.wall.data import KINDS
from sim2real.segmentation.events import ContactEvent
from sim2real.segmentation.mallet_path import MalletPath
from sim2real.segmentation.velocity_jumps import VelocityJump

STEP = 1e-6  # s, m, m/s: difference step of the inputs for derivatives
TIME, PLACE, V_IN, V_OUT, MALLET, MALLET_V = 0, slice(1, 3), slice(3, 5), slice(5, 7), slice(7, 9), slice(9, 11)
INPUTS = 11


@dataclass(frozen=True)
class Spin:
    """Of a puck before a contact [rad/s], and whether it is known; else it is a guess."""

    value: float = 0.0
    known: bool = False


@dataclass(frozen=True)
class ContactError:
    """A contact and its prediction; velocities (2,) [m/s] along the normal and the tangent.

    `before`, `after`: recorded velocities, relative to the mallet for a mallet contact; `predicted`: predicted velocity
    after; `std`: standard deviation of `error` due to noise alone; `spin`: predicted spin after, known where
    that before was.
    """

    contact: ContactEvent
    before: np.ndarray
    after: np.ndarray
    predicted: np.ndarray
    std: np.ndarray
    spin: Spin

    @property
    def error(self) -> np.ndarray:
        """The velocity after (2,) [m/s], recorded minus predicted."""
        return self.after - self.predicted


def predict_wall(jump: VelocityJump, p: np.void, map_error: MapError, spin: Spin) -> ContactError:
    """Predict the velocity after a wall contact from the velocity before, and the puck's `spin` before.

    `p`: the simulator's parameters, with those of effects.
    """
    normal, kind, pucks = jump.contact.normal, KINDS[jump.contact.where], np.zeros(1, PUCK)

    def after(inputs: np.ndarray) -> np.ndarray:
        _place(pucks[0], inputs, spin)
        rebound(pucks[0], p, jump.t, kind, *map(float, normal))
        return np.array([pucks[0]["vx"], pucks[0]["vy"]])

    inputs, spread = np.zeros(INPUTS), np.zeros((INPUTS, INPUTS))
    inputs[:7], spread[:7, :7] = jump.state, jump.covariance
    axes = _axes(normal)
    by_map = _by_map(inputs, map_error, seen_by_camera=False)
    std = _std(lambda z: axes @ (z[V_OUT] - after(z)), inputs, spread + by_map @ by_map.T)
    predicted = axes @ after(inputs)
    velocities, left = (axes @ jump.v_in, axes @ jump.v_out, predicted, std), float(pucks[0]["spin"])
    return ContactError(jump.contact, *velocities, Spin(left, spin.known))


def predict_mallet(
    jump: VelocityJump, mallet: MalletPath, p: np.void, map_error: MapError, spin: Spin
) -> ContactError | None:
    """Predict the velocity after a mallet contact from those of puck and mallet before; all relative to the mallet.

    The normal is the line of centres; `p` and `spin` as of `predict_wall`. None if too few samples show the mallet.
    """
    motion = mallet.motion(jump.t)
    if motion is None:
        return None
    (place, velocity, acceleration), covariance = motion
    pucks = np.zeros(1, PUCK)

    def after(inputs: np.ndarray) -> np.ndarray:
        later = inputs[TIME] - jump.t  # the mallet moves during an error of the contact's time
        m, m_v = inputs[MALLET] + later * velocity, inputs[MALLET_V] + later * acceleration
        normal = (inputs[PLACE] - m) / np.linalg.norm(inputs[PLACE] - m)
        _place(pucks[0], inputs, spin)
        strike(pucks[0], p, jump.t, *map(float, (*m_v, *normal)))
        return np.array([pucks[0]["vx"], pucks[0]["vy"]])

    inputs, spread = np.concatenate([jump.state, place, velocity]), np.zeros((INPUTS, INPUTS))
    spread[:7, :7] = jump.covariance
    for axis in (0, 1):
        rows = np.array([MALLET.start, MALLET_V.start]) + axis
        spread[np.ix_(rows, rows)] = covariance[axis, :2, :2]
    axes = _axes((jump.place - place) / np.linalg.norm(jump.place - place))
    by_map = _by_map(inputs, map_error, seen_by_camera=jump.contact.where == "opponent")
    std = _std(lambda z: axes @ (z[V_OUT] - after(z)), inputs, spread + by_map @ by_map.T)
    before, measured, predicted = (axes @ (v - velocity) for v in (jump.v_in, jump.v_out, after(inputs)))
    left = Spin(float(pucks[0]["spin"]), spin.known)
    return ContactError(jump.contact, before, measured, predicted, std, left)


def _place(puck: np.void, inputs: np.ndarray, spin: Spin) -> None:
    """Place a puck just before a contact."""
    puck["x"], puck["y"] = inputs[PLACE]
    puck["vx"], puck["vy"] = inputs[V_IN]
    puck["spin"] = spin.value


def _axes(normal: np.ndarray) -> np.ndarray:
    """Axes (2, 2) along a normal (2,) and along its tangent, in rows."""
    return np.array([normal, [-normal[1], normal[0]]])


def _by_map(inputs: np.ndarray, map_error: MapError, seen_by_camera: bool) -> np.ndarray:
    """Deviations (INPUTS, m) of the inputs due to the map error; of the mallet too if the camera observed it."""
    place, v_in = map_error.of_motion(inputs[PLACE], inputs[V_IN])
    by_map = np.zeros((INPUTS, place.shape[1]))
    by_map[PLACE], by_map[V_IN] = place, v_in
    by_map[V_OUT] = map_error.of_motion(inputs[PLACE], inputs[V_OUT])[1]
    if seen_by_camera:
        by_map[MALLET], by_map[MALLET_V] = map_error.of_motion(inputs[MALLET], inputs[MALLET_V])
    return by_map


def _std(function: Callable[[np.ndarray], np.ndarray], inputs: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Standard deviations (k,) of a `function` (k,) of inputs (n,) with this covariance (n, n), to first order."""
    here = function(inputs)
    jacobian = np.stack([(function(moved) - here) / STEP for moved in inputs + STEP * np.eye(len(inputs))], axis=1)
    return np.sqrt(np.diag(jacobian @ covariance @ jacobian.T))
