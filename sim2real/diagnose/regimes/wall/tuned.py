"""Tuned numbers of the wall regime."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class WallNumbers:
    """Tuned numbers of contacts with walls: selection, candidate laws, and scatter."""

    least_closing_speed: float = tuned(
        0.05,
        "m/s",
        "less takes a slide along a wall for a contact; more loses slow contacts",
        "choice: noise can reverse a slower approach",
    )
    time_error: float = tuned(
        0.02,
        "s",
        "less leaves the place of a contact with a post off the post's circle; more follows a motion past it",
        "choice: a contact's time is known to a few frames",
    )
    fewest_of_wall: int = tuned(
        3,
        "contacts",
        "fewer let a single outlier be a wall's usual restitution; more judge a wall by the others",
        "choice: the least number whose median one outlier does not set",
    )
    most_unusual_restitution: float = tuned(
        0.3,
        "1",
        "less drops contacts of a wall whose restitution varies; more keeps contacts with something else as well",
        "choice: no wall's restitution differs so much from one contact to the next",
    )
    most_friction: float = tuned(
        1.0,
        "1",
        "less drops contacts with a rough wall; more keeps contacts with something else as well",
        "choice: more than any wall's",
    )
    most_unusual_place: float = tuned(
        12.0,
        "standard deviations",
        "less drops contacts by errors of the glide law; more keeps gaps in which more than a contact happened",
        "choice: twice what a single contact with a wall may be off",
    )
    stretch_edges: int = tuned(
        24, "1", "edges on each wall between which a stretch is searched: fewer miss a short one, more take time",
        "choice: as many as a minute's contacts with a wall",
    )  # fmt: skip
    fewest_of_stretch: int = tuned(
        2, "contacts", "a single one is an outlier; more miss a short stretch, or one that nearly all of a wall is",
        "choice: the least number that agrees with itself",
    )  # fmt: skip
    least_stretch_gain: float = tuned(
        15.0,
        "loss",
        "time for stretches that explain too little to be selected",
        "choice: half of the engine's fit_gain",
    )
    unknown_spin: float = tuned(
        30.0,
        "rad/s",
        "standard deviation of a spin after a contact that was not observed: less claims to know it, more ignores it",
        "choice: friction on a puck of 3 cm radius at 1 m/s gives spins of this size",
    )
    launch_spin: float = tuned(
        1.0,
        "rad/s",
        "standard deviation of a launched puck's spin: less claims to know it, more ignores it",
        "choice: a hand hardly turns the puck that it lets go",
    )
    spin_step: float = tuned(
        1e-3,
        "rad/s",
        "less loses a derivative in rounding; more sees the curvature of the law",
        "choice: a difference step far below `launch_spin`",
    )
    frictions: tuple[float, ...] = tuned(
        (0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5),
        "1",
        "coarser or narrower grids miss a friction, which saturates and so has no derivative at 0",
        "choice: steps of about a half over the coefficients of hard plastics",
    )
    most_waves: float = tuned(
        7.0,
        "waves in 2 m",
        "fewer miss short waves of a restitution; more find one by chance",
        "choice: beyond it few contacts lie on each wave",
    )
    wave_step: float = tuned(
        0.125,
        "waves in 2 m",
        "coarser steps miss the phase of a wave at the end of a wall; finer ones only cost time",
        "choice: an eighth of a wave over the whole table",
    )
    least_length: float = tuned(
        1e-3,
        "m",
        "extent of the contacts along a wall: less divides by zero",
        "choice: far below the distance of any two contacts that show a dependence on place",
    )
    fewest_of_place: int = tuned(
        12,
        "contacts",
        "fewer let a formula select a single wall by chance; more hide a wall that differs from the others",
        "choice: several for each number of a formula",
    )
    rough: float = tuned(
        4.0,
        "1",
        "times the usual sum of squares of a typical contact: less adds scatter where noise is a little larger than "
        "stated, more leaves a rough wall unexplained",
        "choice: the noise would have to be twice as large",
    )
    most_scatter: float = tuned(
        2.0,
        "1",
        "share of the closing speed at which the search for a scatter ends",
        "choice: beyond it a contact carries no information",
    )
    scatter_tolerance: float = tuned(
        0.002,
        "1",
        "less iterates without end; more leaves a scatter that the law does not fit",
        "choice: far below any scatter that matters",
    )
    scatter_rounds: int = tuned(12, "1", "fewer end before the scatter does not change", "choice: it converges sooner")
    search_rounds: int = tuned(
        4,
        "1",
        "times that laws are compared again: fewer leave a law selected under another scatter, more cost minutes",
        "choice: it converges sooner",
    )
    halvings: int = tuned(40, "1", "fewer leave the scatter coarse", "choice: to 2e-12 of `most_scatter`")


WALL = WallNumbers()
