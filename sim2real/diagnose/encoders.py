"""The robot's mallet from its encoders: where it was at any time, and how fast just before and after a blow."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.sensor import estimate_noise
from sim2real.recording import Recording

QUANTUM = 1e-5  # m, the least noise: that of places written in such steps
WINDOW = 0.025  # s on either side of a blow
SAMPLES = 6  # on either side at least, where they are rare
LONGEST_HOLE = 0.05  # s without a sample, across which the path is not told
TUNING_WINDOWS = 24  # of the path, by which its unrest is chosen
JERKS = (1e1, 1e2, 1e3, 1e4, 1e5, 1e6)  # m^2/s^5, the unrests to choose from
LATE = tuple(0.004 * k for k in range(8))  # s, by which a plan's switches may act late
SWITCH = 80.0  # m/s^2, by which a switch of the voltage changes the acceleration
BLOWN = 6.0  # of log likelihood that a window may cost: in some the puck strikes the mallet
UNKNOWN = (0.1, 10.0, 100.0)  # m, m/s, m/s^2: as good as unknown, of place, velocity and acceleration


@dataclass(frozen=True)
class Encoders:
    """A mallet's path: clock `t` (n,) [s], places `p` (n, 2) [m], white noise [m] of a coordinate.

    Its acceleration is taken for a Wiener process of intensity `unrest` [m^2/s^5] that jumps at `switches`: an axis
    each; the second are the times at which its voltage is switched (empty where the commands are unknown).
    """

    t: np.ndarray
    p: np.ndarray
    noise: float
    unrest: tuple[float, float]
    switches: tuple[np.ndarray, np.ndarray]

    def at(self, when: np.ndarray) -> np.ndarray:
        """Places (..., 2) at the times `when` (...); nan beyond the ends and in holes of the stream."""
        right = np.clip(np.searchsorted(self.t, when), 1, len(self.t) - 1)
        share = (when - self.t[right - 1]) / (self.t[right] - self.t[right - 1])
        place = self.p[right - 1] + share[..., None] * (self.p[right] - self.p[right - 1])
        hole = self.t[right] - self.t[right - 1] > LONGEST_HOLE
        return np.where((hole | (share < 0) | (share > 1))[..., None], np.nan, place)

    def blow(self, when: float) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Velocity (2,) just before `when`, its step (2,) there, and their covariances (2, 2, 2), an axis each.

        Generalised least squares under the random acceleration. None where the stream does not tell.
        """
        here = self._around(when)
        u, q = self.t[here] - when, self.p[here]
        if min((u < 0).sum(), (u >= 0).sum()) < 3 or np.diff(u).max() > LONGEST_HOLE:
            return None
        basis = np.stack([np.ones_like(u), u, u * u / 2, np.maximum(u, 0.0)], axis=1)
        before, step, spread = np.zeros(2), np.zeros(2), np.zeros((2, 2, 2))
        for axis in (0, 1):
            weight = np.linalg.inv(self._covariance(u, axis, when))
            covariance = np.linalg.inv(basis.T @ weight @ basis)
            fit = covariance @ (basis.T @ (weight @ q[:, axis]))
            before[axis], step[axis] = fit[1], fit[3]
            spread[axis] = covariance[np.ix_([1, 3], [1, 3])]
        return before, step, spread

    def likelihoods(self, axis: int, windows: np.ndarray) -> np.ndarray:
        """Log likelihood (n,) of the samples around each of the times `windows` (n,), with the path's place, velocity
        and acceleration there unknown."""
        found = np.zeros(len(windows))
        for k, when in enumerate(windows):
            here = self._around(float(when))
            u, q = self.t[here] - when, self.p[here, axis] - self.p[here, axis].mean()
            basis = np.stack([np.ones_like(u), u, u * u / 2], axis=1) * UNKNOWN
            root = np.linalg.cholesky(self._covariance(u, axis, float(when)) + basis @ basis.T)
            found[k] = -np.log(np.diag(root)).sum() - 0.5 * float((np.linalg.solve(root, q) ** 2).sum())
        return found

    def _around(self, when: float) -> slice:
        near = int(np.searchsorted(self.t, when))
        first, last = np.searchsorted(self.t, [when - WINDOW, when + WINDOW])
        return slice(max(0, min(int(first), near - SAMPLES)), max(int(last), near + SAMPLES))

    def _covariance(self, u: np.ndarray, axis: int, when: float) -> np.ndarray:
        """Covariance (n, n) of places at the times `when + u` about a parabola, from noise, unrest and switches."""
        near = self.switches[axis] - when
        near = near[(near > u[0]) & (near < u[-1])]
        beyond = np.where(near < 0, near - u[:, None], u[:, None] - near)  # no switch bends the path at 0 itself
        bends = SWITCH * np.maximum(beyond, 0.0) ** 2 / 2
        return self.noise**2 * np.eye(len(u)) + self.unrest[axis] * restless(u) + bends @ bends.T


def read_encoders(recording: Recording) -> Encoders | None:
    """The encoders of a recording; None where they saw too little."""
    if recording.mallet is None:
        return None
    stream = recording.mallet
    p = np.stack([stream["mallet_x"], stream["mallet_y"]], axis=1)
    seen = np.isfinite(p).all(axis=1)
    t, p = stream.t[seen], p[seen]
    if len(t) < 8 * SAMPLES:
        return None
    noise = max(estimate_noise(t, p).position, QUANTUM)
    return _tune(Encoders(t, p, noise, (JERKS[-1], JERKS[-1]), _switches(recording)))


def _switches(recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """When each axis' voltage is switched, by the commands: at a plan's start and at its two times, if it lasts."""
    if recording.commands is None or not recording.commands.rows:
        return np.zeros(0), np.zeros(0)
    plans = recording.commands
    until = np.append(plans.t[1:], np.inf)
    times = []
    for axis in "xy":
        later = [plans.t + plans[f"t_{axis}{k}"] for k in (1, 2)]
        times.append(np.sort(np.concatenate([plans.t, *(each[each < until] for each in later)])))
    return times[0], times[1]


def _tune(encoders: Encoders) -> Encoders:
    """The unrest, and the lateness of the switches, that make the path likeliest where the mallet moves most."""
    windows = _lively(encoders)
    ways = [(np.zeros(0), np.zeros(0))]
    if len(encoders.switches[0]):
        ways += [(encoders.switches[0] + late, encoders.switches[1] + late) for late in LATE]
    options = [[replace(encoders, unrest=(jerk, jerk), switches=way) for jerk in JERKS] for way in ways]
    heights = np.array([[[each.likelihoods(axis, windows) for each in row] for row in options] for axis in (0, 1)])
    heights = np.maximum(heights, heights.max(axis=(1, 2), keepdims=True) - BLOWN).sum(axis=3)
    way = int(heights.max(axis=2).sum(axis=0).argmax())
    x, y = heights[:, way].argmax(axis=1)
    return replace(encoders, unrest=(JERKS[x], JERKS[y]), switches=ways[way])


def _lively(encoders: Encoders) -> np.ndarray:
    """Times (TUNING_WINDOWS,) spread over the half of the path that is the faster one."""
    grid = np.linspace(encoders.t[0] + WINDOW, encoders.t[-1] - WINDOW, 20 * TUNING_WINDOWS)
    speed = np.linalg.norm(encoders.at(grid + WINDOW) - encoders.at(grid - WINDOW), axis=1)
    fast = grid[speed >= np.nanmedian(speed)] if np.isfinite(speed).any() else grid
    return fast[np.linspace(0, len(fast) - 1, TUNING_WINDOWS).astype(int)]


def restless(u: np.ndarray) -> np.ndarray:
    """Covariance (n, n) of places at the times `u` if the acceleration is a Wiener process of unit intensity, 0 at 0.

    Thrice integrated white noise on either side of 0: integral of (a - s)^2 (b - s)^2 / 4 over 0 < s < a < b.
    """
    a = np.minimum(np.abs(u)[:, None], np.abs(u))
    gap = np.abs(np.abs(u)[:, None] - np.abs(u))
    return np.where(u[:, None] * u > 0, (a**5 / 5 + gap * a**4 / 2 + gap**2 * a**3 / 3) / 4, 0.0)
