"""Tuned numbers of the mallet regime."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class MalletNumbers:
    """Tuned numbers of contacts with the mallet: selection, and the sizes at which friction is linearised."""

    least_closing_speed: float = tuned(
        0.1,
        "m/s",
        "less takes a puck that leans on the mallet for a contact; more loses slow contacts",
        "choice: twice that of the walls, since the mallet's velocity has an error as well",
    )
    longest_delay: float = tuned(
        0.012,
        "s",
        "time between the contact's estimate and the moment at which the motions before and after meet: less loses "
        "contacts of slow cameras, more keeps gaps in which more than a contact happened",
        "choice: about two frames of a camera",
    )
    farthest_rims: float = tuned(
        0.006,
        "m",
        "distance between the rims at a contact: less loses contacts by the clocks' offset, more takes other contacts "
        "for those of the mallet",
        "choice: as far as a wall may be off its place (`segmentation.causes.NEAR`)",
    )
    wall_keeps: float = tuned(
        0.5,
        "of the speed towards it",
        "more takes a contact with mallet and wall for one with the mallet, less loses contacts beside walls",
        "choice: a wall that keeps less is hardly one",
    )
    gross_error: float = tuned(
        30.0,
        "times a typical contact's residual",
        "less leaves out contacts of a law that few of them meet, more lets a wrong one spoil the clock of all",
        "choice: far beyond what laws differ by between contacts",
    )
    gross_share: float = tuned(0.1, "of contacts", "contacts left out until a law fits", "choice: outliers are few")
    clock_error: float = tuned(
        0.0005,
        "s",
        "standard deviation of what remains of an offset between the mallet's clock and the camera's: less takes an "
        "offset for a law of contacts, more loses friction at contacts of a mallet that always moves alike",
        "choice: the smallest delay of the camera that is named (`regimes.sensing.tuned.CLOCK.least_delay`)",
    )
    clock_step: float = tuned(
        1e-6,
        "s",
        "less loses a derivative in rounding; more sees the curvature of the law",
        "choice: a difference step far below what any clock is known by",
    )
    frictions: tuple[float, ...] = tuned(
        (0.05, 0.1, 0.2, 0.4),
        "1",
        "coarser or narrower grids miss a friction, which saturates and so has no derivative at 0",
        "choice: steps of two over the coefficients of hard plastics",
    )


MALLET = MalletNumbers()
