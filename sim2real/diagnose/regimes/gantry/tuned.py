"""Tuned numbers of the gantry regime."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class GantryDataNumbers:
    """Tuned numbers of the data: selection of encoder samples, and windows."""

    window: float = tuned(
        0.5,
        "s",
        "longer windows add up errors of the model; shorter ones spend their samples on their starts",
        "choice: a few time constants of an axis",
    )
    fewest_samples: int = tuned(
        20, "samples", "fewer leave a window little beside its start", "choice: several for each number of a start"
    )
    longest_hole: float = tuned(
        6.0,
        "median periods",
        "longer holes hide what the mallet did; shorter ones cut at jitter",
        "choice: a few samples may be missing",
    )
    longest_block: float = tuned(
        3.0, "s", "clusters of fewer windows correlate; longer ones are too few to resample", "choice: six windows"
    )
    blocks: int = tuned(
        20,
        "blocks",
        "fewer clusters make intervals uncertain where the recording is short",
        "choice: enough to resample",
    )
    fewest_windows: int = tuned(
        12, "windows", "fewer do not determine the baseline's parameters", "choice: six seconds of motion"
    )
    least_travel: float = tuned(
        0.01,
        "m",
        "standard deviation of the path: with less, noise and backlash dominate",
        "choice: ten times a large backlash",
    )
    most_samples: int = tuned(
        10_000,
        "samples",
        "more cost time without more information: neighbours are redundant",
        "choice: a fit of some seconds",
    )
    thin_window: int = tuned(
        10, "samples", "fewer in a window of a thinned record tell little beside its start", "choice: twice its columns"
    )
    spare_samples: float = tuned(
        1.5,
        "1",
        "times `fewest_samples` that a thinned window keeps: less loses windows at irregular stamps",
        "choice: half as many again",
    )
    longest_delay: float = tuned(
        0.05,
        "s",
        "after unrecorded drive inputs, how long they still act: less fits what is unknown, more discards samples",
        "choice: above any delay of a command",
    )
    smoothing: float = tuned(
        0.009, "s", "less leaves noise in the speed, more rounds off reversals", "choice: a few samples of the encoders"
    )
    dry_speed: float = tuned(
        0.0005,
        "m/s",
        "speed scale of dry friction, tanh(v / scale): less takes shorter steps, with more an axis at rest creeps",
        "choice: a tenth of a millimetre in a pause of 0.2 s",
    )
    dry_step: float = tuned(
        1e-4, "s", "for which friction is held: more lets the speed of an axis at rest swing", "choice: stable at 1 V"
    )
    dry_longest: float = tuned(
        2e-3,
        "s",
        "the same while an axis sticks: more misses how it creeps, less is slower",
        "rms of a thinned path's residuals: 1.0 times the noise with it, 1.2 without",
    )
    dry_saturated: float = tuned(
        5.0,
        "dry_speed",
        "above it friction is constant until a reversal: less holds what changes, more takes more steps",
        "choice: tanh(5) is 0.9999",
    )
    dry_agreed: float = tuned(
        0.01,
        "V",
        "a step whose friction at the end is that of its linear law: more blurs when an axis lets go, less is slower",
        "rms error of paths by steps of 0.1 ms: 14 um with it, 13 um without long steps",
    )
    start_shown: float = tuned(
        0.1,
        "s",
        "after a push, how long the path shows its speed: less leaves noise in it, with more wrong friction bends it",
        "choice: a few samples of a thinned record, less than a time constant of an axis",
    )
    start_samples: int = tuned(
        4,
        "samples",
        "fewer leave no rest beside the two numbers of a speed's fit; more reach past a time constant of a thin record",
        "choice: twice the numbers",
    )
    start_rounds: int = tuned(
        3, "rounds", "fewer leave friction of the wrong direction in it, more take time", "choice: each corrects most"
    )
    run_in: float = tuned(
        1.0,
        "s",
        "before a window, from rest: less leaves the start's speed, more costs time",
        "choice: ten times C6 / C7",
    )
    same_step: float = tuned(
        1e-7,
        "m",
        "differences of positions nearer than this are one step of the encoders",
        "choice: below any step, above the rounding of a file",
    )
    switch_error: float = tuned(
        1e-6,
        "s",
        "the digits to which the switching times of a plan are written",
        "choice: microseconds in commands.csv",
    )
    time_rounding: float = tuned(
        1e-9,
        "s",
        "less puts a change that falls on a tick on the next one",
        "choice: above the rounding of sums of times",
    )


@dataclass(frozen=True)
class GantryFitNumbers:
    """Tuned numbers of fits of the baseline and of the listed effects."""

    prior_share: float = tuned(
        0.2,
        "1",
        "standard deviation of a1 and b1 about the simulator's own, as a share: more "
        "lets them absorb a delay, less biases them",
        "choice: they are nearly a delay of the path, which alone hardly determines them",
    )
    difference_step: float = tuned(
        1e-6,
        "size of the parameter",
        "less loses a derivative in rounding, more sees the curvature",
        "choice: a difference step below any standard error",
    )
    least_size: float = tuned(
        1e-3,
        "range of the parameter",
        "the size of a parameter that is zero, for `difference_step`",
        "choice: a small value that can be distinguished from zero",
    )
    impossible: float = tuned(
        1e6,
        "standard deviations",
        "the residual if an axis is not overdamped: less may look better than a bad law",
        "choice: far beyond any residual",
    )
    followed: int = tuned(
        2, "starts", "fewer miss the best minimum, more cost time", "choice: the most promising by their derivatives"
    )
    rounds: int = tuned(15, "steps", "fewer end a fit before it converges", "choice: fits converge sooner")
    continued: int = tuned(10, "1", "how often the best effect's fit may be continued", "choice: fits end before")
    still_better: float = tuned(
        0.9,
        "1",
        "share of the excess below which continuing a fit was worth it: more takes time, less stops halfway",
        "choice: a tenth better",
    )
    samples: int = tuned(
        3000,
        "samples",
        "fewer blur which effect is best, more cost time; the chosen law is fitted anew to all",
        "choice: a fit of about a second",
    )
    delay_steps: tuple[float, ...] = tuned(
        tuple(0.125 * k for k in range(-8, 9)),
        "ticks",
        "coarser steps about a delay miss its plateau between two ticks",
        "choice: an eighth of a tick",
    )
    most_effects: int = tuned(3, "effects", "more compensate each other's errors", "choice: few tables lack more")
    little_left: float = tuned(
        1.1,
        "1",
        "mean square residual in units of the noise below which no effect is tried: less names effects by chance",
        "choice: a tenth above the noise",
    )
    much_left: float = tuned(
        2.0,
        "1",
        "mean square residual above which the effects found must explain `later_share`",
        "choice: as much misfit as noise",
    )
    first_share: float = tuned(
        0.3,
        "1",
        "share of the excess that the first effect must explain: less names wrong effects that imitate others",
        "choice: about a third",
    )
    later_share: float = tuned(
        0.9, "1", "share of the excess that a further effect must explain", "choice: nearly all of it"
    )
    firsts: int = tuned(3, "effects", "fewer miss a pair, more cost time", "choice: of a pair, one is among the best")
    most_share: float = tuned(
        0.7,
        "1",
        "share of the excess that one effect must explain to be named where much remains: less names imitators",
        "choice: friction explains three quarters on a real gantry",
    )
    far_less: float = tuned(
        0.5, "1", "what it may leave, as a share of what any other leaves, likewise", "choice: half"
    )
    significance: float = tuned(
        3.0, "standard deviations", "less names effects whose size may be zero", "choice: once in 400 by chance"
    )


@dataclass(frozen=True)
class ControlTickNumbers:
    """Tuned numbers of the search for the period of the motors' control loop."""

    periods: tuple[float, ...] = tuned(
        (1e-4, 2e-4, 2.5e-4, 5e-4, 1e-3, 2e-3, 2.5e-3, 4e-3, 5e-3, 1e-2),
        "s",
        "periods that are missing here look like late switches",
        "choice: usual rates of control loops, 100 Hz to 10 kHz",
    )
    windows: int = tuned(16, "windows", "fewer do not determine a period, more cost time", "choice: eight seconds")
    samples: int = tuned(
        2000, "samples", "fewer blur the switches, more cost time", "choice: about a hundred for each window"
    )
    least_excess: float = tuned(
        0.05,
        "1",
        "log of a window's mean square in units of the noise below which nothing is "
        "missing: less finds ticks by chance",
        "choice: a twentieth above the noise",
    )
    followed: int = tuned(
        2, "periods", "fewer miss the best one, more cost time", "choice: the most promising by their derivatives"
    )
    rounds: int = tuned(15, "steps", "fewer end a fit before it converges", "choice: fits converge sooner")
    delay_steps: tuple[float, ...] = tuned(
        (-1.0, -0.75, -0.5, -0.25, 0.0),
        "ticks",
        "by which a delay may be less than without ticks: coarser steps miss it",
        "choice: quarters of a tick",
    )
    least_share: float = tuned(
        0.3,
        "1",
        "share of the excess that a period must explain to be accepted: less mistakes missing physics for a tick",
        "choice: about a third",
    )


@dataclass(frozen=True)
class GantryLawNumbers:
    """Tuned numbers of smooth laws and their formulas."""

    knots: int = tuned(
        8,
        "knots",
        "fewer blur a law of place, speed or volts, more fit noise",
        "choice: several for each metre of an axis",
    )
    time_knots: int = tuned(5, "knots", "fewer blur a law of time, more follow single plans", "choice: slow changes")
    harmonics: int = tuned(
        3,
        "harmonics",
        "fewer blur a law of the heading, more fit noise",
        "choice: forces of two axes and their squares",
    )
    friction_speed: float = tuned(
        0.03,
        "m/s",
        "the speed above which dry friction is constant: less is a step that no "
        "smoothed speed shows, more looks like damping",
        "choice: a slow crawl",
    )
    memories: tuple[float, ...] = tuned(
        (0.03, 0.1, 0.3, 1.0),
        "s",
        "time constants that are missing here are blurred into their neighbours",
        "choice: steps of about three",
    )
    independent: float = tuned(
        0.03,
        "1",
        "share of a family's largest singular value: less keeps directions that the baseline's own "
        "terms can represent, more loses parts of a law",
        "choice: as the noise of a column",
    )
    bins: int = tuned(30, "bins", "fewer blur the curve of a law, more make it rough", "choice: a law has no noise")
    least_driver: float = tuned(
        0.1, "1", "share of the rms of the driver of the volts: less divides by nearly zero", "choice: a tenth"
    )
    formula_rounds: int = tuned(
        3, "steps", "fewer leave parameters inconsistent with the formula", "choice: it converges sooner"
    )


GANTRY_DATA = GantryDataNumbers()
GANTRY_FIT = GantryFitNumbers()
CONTROL_TICK = ControlTickNumbers()
GANTRY_LAW = GantryLawNumbers()
