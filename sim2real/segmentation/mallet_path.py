"""The motion of a recorded mallet at any time: the robot's by its encoders, the opponent's by the camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim2real.recording.folder import Recording, Stream
from sim2real.segmentation.sensor_noise import estimate_noise
from sim2real.segmentation.tuned import SEGMENTATION

DIFFUSE = (0.1, 10.0, 100.0)  # m, m/s, m/s^2: diffuse prior of place, velocity and acceleration
Switches = tuple[np.ndarray, np.ndarray]  # times [s] at which each axis' voltage changes
NO_SWITCHES: Switches = (np.zeros(0), np.zeros(0))


@dataclass(frozen=True)
class MalletPath:
    """A sampled path: clock `t` (n,) [s], places `p` (n, 2) [m], white noise [m] of a coordinate.

    The acceleration is a Wiener process of intensity `jerk` [m^2/s^5] with jumps at `switches` [s], one entry for each
    axis. The switches are the times at which the axis' voltage changes (empty if the commands are unknown).
    """

    t: np.ndarray
    p: np.ndarray
    noise: float
    jerk: tuple[float, float]
    switches: Switches

    def at(self, when: np.ndarray) -> np.ndarray:
        """Places (..., 2) [m] at the times `when` (...) [s]; nan beyond the ends and in holes of the stream."""
        right = np.clip(np.searchsorted(self.t, when), 1, len(self.t) - 1)
        share = (when - self.t[right - 1]) / (self.t[right] - self.t[right - 1])
        place = self.p[right - 1] + share[..., None] * (self.p[right] - self.p[right - 1])
        hole = self.t[right] - self.t[right - 1] > SEGMENTATION.path_hole
        return np.where((hole | (share < 0) | (share > 1))[..., None], np.nan, place)

    def motion_at_contact(self, when: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None:
        """Velocity (2,) [m/s] just before `when` [s], its step (2,) there, their covariances (2, 2, 2) by axis, and the
        acceleration (2,) [m/s^2].

        None if the stream has too few samples there.
        """
        fits = self._fits(when, step=True)
        if fits is None:
            return None
        before, acceleration, step = np.array([fit[1:] for fit, _ in fits]).T
        return before, step, np.array([covariance[np.ix_([1, 3], [1, 3])] for _, covariance in fits]), acceleration

    def motion(self, when: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Place, velocity and acceleration (3, 2) at `when` [s] of a mallet without a contact, and their covariances
        (2, 3, 3) by axis, in SI units. None if the stream has too few samples there."""
        fits = self._fits(when, step=False)
        if fits is None:
            return None
        return np.array([fit for fit, _ in fits]).T, np.array([covariance for _, covariance in fits])

    def likelihoods(self, when: float, jerks: np.ndarray, candidates: Sequence[Switches]) -> np.ndarray:
        """Log likelihood (2, candidates, jerks) of the samples around a time [s], along each axis, with these switches
        and jerks instead of the path's own, and place, velocity and acceleration there unknown."""
        here = self._around(when)
        u, q = self.t[here] - when, self.p[here] - self.p[here].mean(axis=0)
        basis = np.stack([np.ones_like(u), u, u * u / 2], axis=1) * DIFFUSE
        common = self.noise**2 * np.eye(len(u)) + basis @ basis.T
        smooth = common + jerks[:, None, None] * wiener_covariance(u)
        found = np.empty((2, len(candidates), len(jerks)))
        for k, switches in enumerate(candidates):
            for axis in range(2):
                bends = _bends(u, switches[axis] - when)
                root = np.linalg.cholesky(smooth + bends @ bends.T)
                white = np.linalg.solve(root, np.broadcast_to(q[:, axis, None], (len(jerks), len(u), 1)))
                spread = np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1)
                found[axis, k] = -spread - 0.5 * (white**2).sum(axis=(1, 2))
        return found

    def _fits(self, when: float, step: bool) -> list[tuple[np.ndarray, np.ndarray]] | None:
        """For each axis the estimates (k,) and their covariance (k, k) by generalised least squares.

        The estimates are place, velocity and acceleration at `when`, and the velocity step there if `step`.
        """
        here = self._around(when)
        u, q = self.t[here] - when, self.p[here]
        if min((u < 0).sum(), (u >= 0).sum()) < 3 or np.diff(u).max() > SEGMENTATION.path_hole:
            return None
        columns = [np.ones_like(u), u, u * u / 2, np.maximum(u, 0.0)]
        basis = np.stack(columns if step else columns[:3], axis=1)
        fits = []
        for axis in (0, 1):
            weight = np.linalg.inv(self._covariance(u, axis, when))
            covariance = np.linalg.inv(basis.T @ weight @ basis)
            fits.append((covariance @ (basis.T @ (weight @ q[:, axis])), covariance))
        return fits

    def _around(self, when: float) -> slice:
        """The samples within the window around `when`, with a minimum number on either side."""
        near = int(np.searchsorted(self.t, when))
        window, least = SEGMENTATION.path_window, SEGMENTATION.path_samples
        first, last = np.searchsorted(self.t, [when - window, when + window])
        return slice(max(0, min(int(first), near - least)), max(int(last), near + least))

    def _covariance(self, u: np.ndarray, axis: int, when: float) -> np.ndarray:
        """Covariance (n, n) [m^2] of places at `when + u` about a parabola: noise, random jerk, and switches."""
        bends = _bends(u, self.switches[axis] - when)
        return self.noise**2 * np.eye(len(u)) + self.jerk[axis] * wiener_covariance(u) + bends @ bends.T


def robot_path(recording: Recording) -> MalletPath | None:
    """The path of the robot's mallet from its encoders; None if there are too few samples."""
    return _path(recording.mallet, "mallet", _switches(recording))


def opponent_path(recording: Recording) -> MalletPath | None:
    """The path of the opponent's mallet from the camera; None if too few frames show it."""
    return _path(recording.frames, "opponent", NO_SWITCHES)


def _path(stream: Stream | None, column: str, switches: Switches) -> MalletPath | None:
    if stream is None:
        return None
    p = np.stack([stream[f"{column}_x"], stream[f"{column}_y"]], axis=1)
    seen = np.isfinite(p).all(axis=1)
    t, p = stream.t[seen], p[seen]
    if len(t) < 8 * SEGMENTATION.path_samples:
        return None
    noise = max(estimate_noise(t, p).position, SEGMENTATION.encoder_quantum)
    largest = SEGMENTATION.jerks[-1]
    return _tune(MalletPath(t, p, noise, (largest, largest), switches))


def _switches(recording: Recording) -> Switches:
    """The switching times of each axis' voltage from the commands: start and both times of each plan, unless cut."""
    if recording.commands is None or not recording.commands.rows:
        return NO_SWITCHES
    plans = recording.commands
    until = np.append(plans.t[1:], np.inf)
    times = []
    for axis in "xy":
        later = [plans.t + plans[f"t_{axis}{k}"] for k in (1, 2)]
        times.append(np.sort(np.concatenate([plans.t, *(each[each < until] for each in later)])))
    return times[0], times[1]


def _tune(path: MalletPath) -> MalletPath:
    """Choose the jerk, and whether and how late the voltages' switches act, by maximum likelihood over windows in which
    the mallet moves most. The lag is found roughly first, for one that is wrong by milliseconds is worse than none."""
    windows, lagged = _busy_times(path), _lagged(path.switches, SEGMENTATION.switch_lags)
    if lagged:
        rough = _likeliest(path, windows, lagged)
        lagged = _lagged(rough.switches, SEGMENTATION.switch_lags_between)
    return _likeliest(path, windows, [NO_SWITCHES, *lagged])


def _lagged(switches: Switches, lags: Sequence[float]) -> list[Switches]:
    """The switches at each of the lags [s]; none if there are no switches."""
    return [(switches[0] + lag, switches[1] + lag) for lag in lags] if len(switches[0]) else []


def _likeliest(path: MalletPath, windows: np.ndarray, candidates: Sequence[Switches]) -> MalletPath:
    """The path with the jerk and the switches of maximum likelihood."""
    jerks = SEGMENTATION.jerks
    heights = np.stack([path.likelihoods(float(when), np.array(jerks), candidates) for when in windows], axis=3)
    least = heights.max(axis=(1, 2), keepdims=True) - SEGMENTATION.contact_cost
    heights = np.maximum(heights, least).sum(axis=3)
    best = int(heights.max(axis=2).sum(axis=0).argmax())
    x, y = heights[:, best].argmax(axis=1)
    return replace(path, jerk=(jerks[x], jerks[y]), switches=candidates[best])


def _busy_times(path: MalletPath) -> np.ndarray:
    """Times (SEGMENTATION.tuning_windows,) [s] spread over the faster half of the path."""
    window, count = SEGMENTATION.path_window, SEGMENTATION.tuning_windows
    grid = np.linspace(path.t[0] + window, path.t[-1] - window, 20 * count)
    speed = np.linalg.norm(path.at(grid + window) - path.at(grid - window), axis=1)
    fast = grid[speed >= np.nanmedian(speed)] if np.isfinite(speed).any() else grid
    return fast[np.linspace(0, len(fast) - 1, count).astype(int)]


def _bends(u: np.ndarray, switches: np.ndarray) -> np.ndarray:
    """What the jump of the acceleration at each of the switches within a window moves its places (n, k) by [m]."""
    near = switches[(switches > u[0]) & (switches < u[-1])]
    beyond = np.where(near < 0, near - u[:, None], u[:, None] - near)  # no switch acts at 0 itself
    return SEGMENTATION.switch_step * np.maximum(beyond, 0.0) ** 2 / 2


def wiener_covariance(u: np.ndarray) -> np.ndarray:
    """Covariance (n, n) of places at the times `u` if the acceleration is a Wiener process of unit intensity, 0 at 0.

    Thrice integrated white noise on either side of 0: integral of (a - s)^2 (b - s)^2 / 4 over 0 < s < a < b.
    """
    a = np.minimum(np.abs(u)[:, None], np.abs(u))
    gap = np.abs(np.abs(u)[:, None] - np.abs(u))
    return np.where(u[:, None] * u > 0, (a**5 / 5 + gap * a**4 / 2 + gap**2 * a**3 / 3) / 4, 0.0)
