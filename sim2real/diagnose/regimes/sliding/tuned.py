"""The tuned numbers of the sliding puck's regime."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class SlidingNumbers:
    """Tuned numbers of the selection of glides, the fit of starts, the candidates, and the figures."""

    # data
    smooth_order: int = tuned(
        4, "1",
        "polynomials of lower order leave the curve of a free glide, those of higher order follow unseen contacts",
        "choice: a free glide is a polynomial of this order in time, to the sensor's noise",
    )  # fmt: skip
    smooth_chance: float = tuned(
        1e-4,
        "1",
        "chance at which a true glide is refused; a smaller one lets contacts pass",
        "choice: few per recording",
    )
    smooth_slack: float = tuned(
        1.1, "1", "times the limit of the chi-square: noise that is a little underestimated would refuse glides",
        "choice: five per cent of the noise",
    )  # fmt: skip
    fewest_frames: int = tuned(
        12, "frames", "of a shorter glide the start explains most", "choice: the start takes four of 24 numbers"
    )
    clearance: float = tuned(
        0.003, "m", "nearer to a wall, post or mallet a slow contact may hide; a larger distance costs frames",
        "choice: beside glides of decimetres it costs few frames",
    )  # fmt: skip
    clearance_stds: float = tuned(
        4.0,
        "1",
        "standard deviations of the noise that are added to it, for the same reason",
        "choice: rarely exceeded by chance",
    )
    longest_cluster: float = tuned(
        6.0, "s", "a longer launch counts as several: few long ones leave too few clusters to resample",
        "choice: longer than a launch across the table",
    )  # fmt: skip
    slowest: float = tuned(
        0.05, "m/s", "a slower puck is at rest, or in a hand that sets it down", "choice: friction soon stops it"
    )
    contact_gap: float = tuned(
        0.05, "s", "a glide that begins later than this after a contact is not known to begin there",
        "choice: a few frames",
    )  # fmt: skip
    # start states
    start_steps: int = tuned(
        8, "1", "Gauss-Newton of the start states that does not end", "choice: twice what a usual law needs"
    )
    spin_decay: float = tuned(
        0.3, "1/s", "the side force of a slowly decaying spin is identified as anisotropic friction", "choice: between "
        "the decays of the independent table; with 0.5, one in four of its recordings with a slow decay was wrong",
    )  # fmt: skip
    start_steps_near: int = tuned(
        2, "1", "first steps with the common law's derivatives: without them a step with a law's own, which costs five "
        "paths instead of one, is taken far from the solution", "choice: one for the law, one for curvature",
    )  # fmt: skip
    start_converged: float = tuned(
        100.0, "1", "a step of the starts, in units of `start_step`, that ends their fit: a larger one leaves an error "
        "that forces could explain", "tests/sim2real/diagnose/regimes/sliding/test_start_states.py",
    )  # fmt: skip
    start_step: tuple[float, float, float, float] = tuned(
        (1e-6, 1e-6, 1e-5, 1e-5), "m, m/s",
        "differences for derivatives by the start: smaller ones are rounding, larger ones see the curvature",
        "choice: far below the sensor's noise",
    )  # fmt: skip
    start_ridge: float = tuned(
        1e-9, "1", "share of the trace added to normal equations: starts that no frame determines", "choice: rounding"
    )
    parameter_step: float = tuned(
        1e-5, "1", "share of a parameter's range for derivatives: smaller ones are rounding, larger ones see curvature",
        "choice: between rounding and curvature",
    )  # fmt: skip
    narrowest_range: float = tuned(1e-3, "1", "a range that is too narrow for such a share", "choice: in its own unit")
    excess_stds: float = tuned(
        3.0, "1",
        "standard deviations of chi-square beyond which a glide's scatter enlarges its ends' covariance; fewer do so "
        "by chance", "choice: one in a thousand by chance",
    )  # fmt: skip
    # candidates
    unit: float = tuned(
        0.1, "m/s^2", "a coefficient of 1, which the prior of nonparametric forces expects",
        "choice: about the friction of an air table",
    )  # fmt: skip
    ripples: tuple[int, int] = tuned(
        (14, 8), "1", "cosines along x alone and along y alone: fewer miss narrow forces, more fit noise",
        "choice: waves of about the same length along both axes",
    )  # fmt: skip
    speed_knots: int = tuned(
        8, "1", "knots of forces by speed: fewer miss their shape", "choice: penalized by stiffness"
    )
    history_knots: int = tuned(
        6, "1", "knots of forces by the time since a contact: fewer miss their shape", "choice: denser soon after it"
    )
    wave_span: float = tuned(
        240.0, "s",
        "the periods of waves in time are this over whole numbers: with a longer span a minute hardly distinguishes "
        "neighbours, with a shorter one a wave lies between them", "choice: four minutes",
    )  # fmt: skip
    wave_numbers: tuple[int, int] = tuned(
        (6, 97), "1", "whole numbers from the first to below the last: 40 s, as long as a drift, to 2.5 s",
        "choice: between half a launch and a drift",
    )  # fmt: skip
    patch_radii: tuple[float, ...] = tuned(
        (0.05, 0.1, 0.15, 0.2, 0.3, 0.45), "m", "radii at which friction patches are searched",
        "choice: from the puck's to nearly half of the width",
    )  # fmt: skip
    patch_spacing: float = tuned(
        0.7,
        "1",
        "distance of neighbouring discs in radii: a larger one leaves gaps between discs",
        "choice: they overlap",
    )
    least_patch_spacing: float = tuned(
        0.06, "m", "the same for the smallest discs, of which there would be too many", "choice: about the puck's width"
    )
    patches_kept: int = tuned(
        2,
        "1",
        "places that are offered by either search: the best on the grid may not be the best fit",
        "choice: a patch, and the rest of the table",
    )
    patch_refinements: int = tuned(
        2, "1", "rounds of looking nearby, each with half the step", "choice: a quarter step"
    )
    patch_growth: float = tuned(0.4, "1", "step of the radius in radii, in the same search", "choice: as the places'")
    span_edges: int = tuned(
        48, "1", "places of edges in the first search, as many frames apart: with fewer a short span is missed",
        "choice: a fiftieth of the data",
    )  # fmt: skip
    widest_span: float = tuned(
        0.9, "of the data", "a span that differs from no span at a few frames alone", "choice: a tenth is outside"
    )
    least_search_gain: float = tuned(
        15.0, "loss", "time for forces that explain too little to be selected", "choice: half of the engine's fit_gain"
    )
    span_refinements: int = tuned(
        4, "1", "rounds of looking nearby, the first with half the distance of two edges, each with half the step",
        "choice: a sixteenth of that distance",
    )  # fmt: skip
    pulse_begins: int = tuned(12, "1", "beginnings of pulses in the first search, of a period", "choice: as hours")
    pulse_shares: tuple[float, ...] = tuned(
        (0.15, 0.3, 0.5), "1", "shares of a period that pulses last, in the first search", "choice: up to a half"
    )
    patch_chunk: int = tuned(
        120,
        "discs",
        "discs at a time: their columns for all frames must fit into memory",
        "choice: about 20 MB for a minute at 150 Hz",
    )
    central_sizes: tuple[float, ...] = tuned(
        (0.1, 0.2, 0.35), "1", "sizes of forces about a point, in widths of the table, from which a fit starts",
        "choice: nearly factors of two",
    )  # fmt: skip
    # extrapolation and figures
    runge_kutta_step: float = tuned(
        0.001, "s", "longest step of the extrapolation: a friction patch begins and ends within one",
        "tests/sim2real/diagnose/regimes/sliding/test_extrapolate.py",
    )  # fmt: skip
    window: float = tuned(
        0.7, "s", "length of an acceleration window: the acceleration's noise falls with its 2.5th power, and a longer "
        "one averages over places", "choice: noise of a window below the forces that matter",
    )  # fmt: skip
    short_window: float = tuned(
        0.3, "s", "the same where what happens soon after a contact matters", "choice: less than half the usual one"
    )
    law_bins: int = tuned(
        30,
        "1",
        "bins of a law's curve, which has no noise: fewer are coarse",
        "choice: drawn as a line, it looks smooth",
    )


SLIDING = SlidingNumbers()
