"""Tuned numbers of the sensing regime."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class ClockNumbers:
    """Tuned numbers of the camera's clock, by contacts with the robot's mallet."""

    longest_delay: float = tuned(
        0.12,
        "s",
        "less misses slow cameras, more finds delays by chance",
        "choice: 7 frames of a camera of 60 frames a second",
    )
    largest_rate: float = tuned(
        0.001, "1", "less misses bad clocks, more finds drifts by chance", "choice: ten times a bad quartz"
    )
    grid: float = tuned(
        0.0015,
        "s",
        "coarser grids miss the likeliest clock, finer ones cost time",
        "choice: a fast mallet moves by `gap_std` in it",
    )
    gap_std: float = tuned(
        0.0025,
        "m",
        "standard deviation of a gap in the search: less misses contacts of a wrong map, more blurs the delay",
        "choice: errors of the radii and the map together",
    )
    outlier_chance: float = tuned(
        0.05,
        "1",
        "chance that a candidate is no contact with this mallet: less lets outliers decide",
        "choice: one in twenty",
    )
    outlier_range: float = tuned(
        0.1, "m", "range over which the gap of such a candidate spreads", "choice: about a mallet"
    )
    least_alignment: float = tuned(
        0.8,
        "1",
        "cosine between impulse and line of centres: less takes other contacts, more loses those with friction",
        "choice: 37 degrees",
    )
    nuisance_std: tuple[float, ...] = tuned(
        (0.0015, 0.0015, 0.0015, 0.004, 0.004, 0.004),
        "m, m, m, 1, 1, 1",
        "prior of the radii, offsets x, y, scales x, y and shear: less biases the delay by a wrong map, more leaves it "
        "undetermined",
        "choice: what a calibration may leave",
    )
    half_span: float = tuned(
        0.004,
        "s",
        "less makes the mallet's velocity noisy, more averages it over the contact",
        "choice: a few samples of the encoders",
    )
    largest_gap: float = tuned(
        0.02,
        "m",
        "less loses contacts before the fit converges, more takes near misses",
        "choice: several times the errors of a map",
    )
    fewest_contacts: int = tuned(
        4, "contacts", "fewer do not determine a clock", "choice: two more than it has numbers"
    )
    worst_condition: float = tuned(
        1e12, "1", "condition number beyond which delay and rate are not separable", "choice: what rounding leaves"
    )
    rejected: float = tuned(
        1e-3,
        "1",
        "p-value below which delay or drift alone is not enough: more names both by chance",
        "choice: once in a thousand",
    )
    least_delay: float = tuned(
        0.0005, "s", "less names the jitter of time stamps", "choice: above the jitter of stamps"
    )
    better: float = tuned(
        0.9,
        "1",
        "share of the recorded gaps below which the corrected ones must be in launches left out of the fit: more "
        "accepts corrections that do nothing",
        "choice: a tenth better",
    )
    folds: int = tuned(5, "1", "fewer leave too little to fit, more cost time", "choice: a fifth is left out")
    most_deviations: float = tuned(
        12.0,
        "standard deviations",
        "a contact counts no more than this: more lets one outlier decide",
        "choice: beyond any error of a contact",
    )


@dataclass(frozen=True)
class ContactLineNumbers:
    """Tuned numbers of the walls' contact lines."""

    farthest: float = tuned(
        0.06,
        "size of the table",
        "less misses stretched maps, more takes other contacts",
        "choice: above any size that is refused",
    )
    most_slant: float = tuned(0.05, "rad", "less misses sheared maps", "choice: above any shear that is named")
    slants: int = tuned(21, "1", "fewer miss the band of a slanted wall", "choice: odd, so that 0 is one of them")
    band: float = tuned(
        0.006,
        "m",
        "narrower bands lose contacts by noise, wider ones take others",
        "choice: as far as a wall may be off its place",
    )
    fewest_contacts: int = tuned(4, "contacts", "fewer do not determine a line", "choice: two more than it has numbers")
    least_share: float = tuned(
        0.4,
        "1",
        "share of the candidates in the band: less finds lines in other contacts",
        "choice: hardly fewer than half",
    )


@dataclass(frozen=True)
class BounceAngleNumbers:
    """Tuned numbers of the angles by which a map deflects bounces."""

    fewest_bounces: int = tuned(
        6, "bounces", "of a wall: fewer do not separate an angle from friction", "choice: twice the numbers of a wall"
    )
    rolling: float = tuned(
        0.1, "m/s", "velocity along a wall at which it ceases to slip: a step would follow noise", "choice: a slow puck"
    )
    wall_std: float = tuned(
        0.0003,
        "rad",
        "by which opposite walls may differ: less takes crooked cushions for turned walls",
        "choice: a good cushion",
    )
    alike: float = tuned(
        0.01,
        "1",
        "p-value of equal angles: less reads turned walls as a shear, more misses shears by chance",
        "choice: once in a hundred",
    )


@dataclass(frozen=True)
class ScaleNumbers:
    """Tuned numbers of the camera's map, estimated from the contact lines."""

    radius_std: float = tuned(
        0.001,
        "m",
        "prior of the puck's radius: less reads a wrong radius as a stretch",
        "choice: what a good calibration may leave",
    )
    offset_std: float = tuned(
        0.0005, "m", "prior of the map's offsets, likewise", "choice: what a good calibration may leave"
    )
    turn_std: float = tuned(
        0.002, "rad", "prior of the map's rotation, likewise", "choice: what a good calibration may leave"
    )
    wall_place_std: float = tuned(
        0.0003, "m", "error of a wall's place: less gives single walls too much weight", "choice: a good cushion"
    )
    wall_slant_std: float = tuned(0.0005, "rad", "error of a wall's direction, likewise", "choice: a good cushion")
    significance: float = tuned(
        1e-3, "1", "p-value of one of the scales, where together they are significant", "choice: once in a thousand"
    )
    least_scale: float = tuned(0.001, "1", "less names errors that no player notices", "choice: 2 mm of a table")
    most_scale: float = tuned(
        0.022, "1", "a larger scale is taken for a wrong stated size", "choice: no calibrated camera errs by so much"
    )
    most_warped_scale: float = tuned(
        0.05, "1", "the same of a map that no wrong size explains", "choice: twice `most_scale`"
    )
    least_warp: float = tuned(
        0.005, "1", "a smaller shear, or other scale, may come with a wrong size", "choice: a crooked measurement"
    )
    least_explained: float = tuned(
        0.75,
        "1",
        "share of the lines' excess that a map must explain unless `beyond_doubt`: less names hidden contacts",
        "choice: a stretch explains nearly all",
    )
    beyond_doubt: float = tuned(
        1e-12,
        "1",
        "p-value below which a few outliers may hide how much a map explains",
        "choice: far below chance",
    )
    known: float = tuned(
        0.003,
        "1",
        "standard deviation above which the lines do not determine a scale",
        "choice: a seventh of `most_scale`",
    )
    roughly_known: float = tuned(
        0.01,
        "1",
        "standard deviation above which they do not even determine a wrong size",
        "choice: half of `most_scale`",
    )
    contradicted: float = tuned(
        2.5,
        "standard deviations",
        "between the shears by lines alone and with bounces: less loses shears by chance, more takes turned walls",
        "choice: once in eighty",
    )
    folds: int = tuned(20, "1", "fewer leave a wall too few contacts", "choice: nearly one launch at a time")


@dataclass(frozen=True)
class RepeatedFrameNumbers:
    """Tuned numbers of frames that repeat the position before them."""

    moved: float = tuned(
        4.0,
        "standard deviations",
        "less counts a resting puck, more loses slow ones",
        "choice: noise alone hardly reaches it",
    )
    rounding: float = tuned(
        5e-5, "m", "smaller steps repeat by the rounding of a file", "choice: half of the last digit of 0.1 mm"
    )
    rare: float = tuned(
        0.002, "1", "a share that any camera may have: less reports it", "choice: one frame in ten seconds"
    )


@dataclass(frozen=True)
class StampNumbers:
    """Tuned numbers of stamps that are arrivals of regular exposures."""

    stretch: float = tuned(
        2.0,
        "s",
        "in which a clock does not wander: less follows the jitter, more misses a clock that is set",
        "choice: a few hundred frames",
    )
    least_size: float = tuned(
        5e-5, "m", "stamps rounded to microseconds are named (small), or a jitter that moves places is missed (large)",
        "choice: as of the gantry's paths",
    )  # fmt: skip
    fewest_frames: int = tuned(
        60,
        "frames",
        "of a stretch: fewer show a phase by chance, more refuse slow cameras",
        "choice: a camera of 30 frames a second",
    )
    fewest_stretches: int = tuned(
        5, "1", "fewer do not tell how uncertain a period and a jitter are", "choice: ten seconds"
    )
    least_sure: float = tuned(
        0.5, "1", "share of frames whose number is sure: less takes frames that come in bursts", "choice: most of them"
    )
    lags: tuple[int, ...] = tuned(
        (8, 64),
        "frames",
        "over which steps are counted in turn: fewer leave the jitter of single steps in the period",
        "choice: each tells the count of the next",
    )
    least_concentration: float = tuned(
        0.35,
        "1",
        "of the phases: less finds a period in irregular frames, more misses those that jitter by a fifth of it",
        "choice: 0.06 are irregular; real recordings have 0.96 and 0.99",
    )
    period_reach: float = tuned(
        0.005, "1", "of the median step: less misses periods where frames were skipped", "choice: a few skipped frames"
    )
    period_steps: int = tuned(
        100, "1", "fewer miss the period, more cost time", "choice: a hundredth of a turn in a stretch"
    )
    fine_steps: int = tuned(
        20, "1", "the same for steps between the two best of these", "choice: a thousandth of a turn in a stretch"
    )
    much_late: float = tuned(
        0.15,
        "1",
        "of a period: frames that are as late may be late by more than one; more keeps wrong times, less loses frames",
        "choice: a frame that waited for another",
    )
    late_deviations: float = tuned(
        4.0, "standard deviations", "the same where stamps jitter by as much", "choice: noise alone hardly reaches it"
    )
    frames: int = tuned(
        7, "frames", "of a local fit: fewer leave few degrees of freedom, more see friction change", "choice: 60 ms"
    )
    longest_piece: float = tuned(
        2.0, "1", "times as long as without skipped frames: more fits across them", "choice: one in two skipped"
    )
    fewest_pieces: int = tuned(30, "1", "fewer let chance decide", "choice: two seconds of gliding")
    worse: float = tuned(
        1.02,
        "1",
        "how much worse fits with the stamps must be: less names what no prediction notices",
        "choice: an error of a fifth of the noise",
    )


@dataclass(frozen=True)
class SensingConsistencyNumbers:
    """Tuned numbers of the check that recordings are of one table and one camera."""

    largest_scale: float = tuned(
        0.01,
        "1",
        "difference of maps: less refuses cameras that were moved a little, more accepts other tables",
        "choice: half of a wrong size",
    )
    largest_delay: float = tuned(
        0.002, "s", "difference of clocks: less refuses one camera, more accepts two", "choice: a fraction of a frame"
    )
    significance: float = tuned(5.0, "standard deviations", "less refuses recordings by noise", "choice: beyond chance")
    fewest_free: int = tuned(
        5, "contacts", "beyond the numbers of a clock: fewer do not determine it", "choice: as many again"
    )


SIGNIFICANCE_LEVEL = 1e-5  # p-value of exact sensors below which a sensor error is reported
CLOCK = ClockNumbers()
CONTACT_LINES = ContactLineNumbers()
BOUNCE_ANGLES = BounceAngleNumbers()
SCALE = ScaleNumbers()
REPEATED_FRAMES = RepeatedFrameNumbers()
STAMPS = StampNumbers()
CONSISTENCY = SensingConsistencyNumbers()
