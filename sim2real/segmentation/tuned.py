"""Tuned numbers of the segmentation: from frames to segments, contacts and their causes."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class SegmentationNumbers:
    """Thresholds and windows, in the order of the processing steps."""

    # sensor_noise: noise and outliers
    noise_floor: float = tuned(
        1e-5, "m", "zero noise, which gives infinite weights", "choice: the last digit of most streams"
    )
    longest_gap: float = tuned(
        0.1, "s", "a prediction across frames that are missing", "choice: a dozen frames at 120 Hz"
    )
    slow: float = tuned(
        0.15, "m/s", "a clock's noise taken for the position's", "choice: 1 ms moves such a puck by 0.15 mm only"
    )
    fast: float = tuned(
        0.6, "m/s", "a clock's noise estimated where it does not show", "choice: four times the slow speed"
    )
    outlier_least: float = tuned(
        0.002, "m", "ordinary frames of a sharp camera taken for outliers", "choice: two millimetres are no noise"
    )
    outlier_sigmas: float = tuned(
        8.0,
        "standard deviations",
        "noise taken for outliers, or outliers for noise",
        "choice: white noise never reaches it",
    )
    # valid_path and segments: launches and glides
    launch_frames: int = tuned(
        5, "frames", "wrong frames between two jumps taken for a motion", "choice: two more than a parabola"
    )
    glide_frames: int = tuned(
        8, "frames", "glides too short to show a law", "choice: more than twice a parabola's numbers"
    )
    handling: float = tuned(
        0.3,
        "s",
        "a puck of which play lost sight taken for one that a hand let go; more ignores what is known of those",
        "choice: no hand takes a puck and puts it down again in less",
    )
    fastest: float = tuned(
        10.0, "m/s", "a fast puck of play taken for one that a hand let go", "choice: no mallet hits a puck faster"
    )
    left_out: float = tuned(
        2.5, "frame periods", "frames without a puck taken for frames that are left out", "choice: two and a half"
    )
    end_frames: int = tuned(
        24, "frames", "an end's velocity that is noise, or no longer local", "choice: 0.2 s at 120 Hz"
    )
    pushed: float = tuned(
        0.4,
        "m/s^2",
        "a hand's push taken for a glide, or a tilted table for a hand",
        "choice: a table that leans by 4 %",
    )
    braked: float = tuned(
        1.5,
        "m/s^2",
        "a puck that a hand sets down taken for a glide, or a sticky table for a hand",
        "choice: five times the friction of a table that hardly slides",
    )
    braked_drag: float = tuned(
        0.2, "1/m", "the same of the drag of a fast puck", "choice: as much as any puck on a table has"
    )
    # changepoints
    window_frames: tuple[int, ...] = tuned(
        (4, 6, 12, 24),
        "frames",
        "sharp events blurred by long windows, slow ones missed by short",
        "choice: each about twice the last",
    )
    long_window: int = tuned(
        6, "frames", "windows longer than this that judge long ways", "choice: the second shortest"
    )
    threshold: float = tuned(
        6.5, "standard deviations", "noise taken for contacts, or contacts missed", "choice, held by test_segments.py"
    )
    threshold_where_expected: float = tuned(
        5.0, "standard deviations", "weak contacts missed at walls and mallets", "choice, held by test_segments.py"
    )
    free_acceleration: float = tuned(
        3.0, "m/s^2", "curved glides taken for contacts (small), short windows that see nothing (large)",
        "choice: the default drag brakes a puck of 5 m/s by as much",
    )  # fmt: skip
    prior_frames: float = tuned(
        4.0,
        "frames",
        "few frames that fit well by chance taken for a fine sensor",
        "choice: the shortest window's side",
    )
    long_window_travel: float = tuned(
        0.06, "m", "a warped image or a force taken for a contact", "choice: two puck radii"
    )
    least_jump: float = tuned(
        0.005, "m", "contacts of a sharp camera taken for jumps", "choice: beside ten times the noise"
    )
    placing_frames: int = tuned(8, "frames", "a changepoint placed a frame off", "choice: two short windows")
    # causes: what was touched
    place_slack: float = tuned(
        0.006, "m", "contacts with no cause (small), or with two (large)", "choice: a fifth of a puck's radius"
    )
    wall_search: float = tuned(
        0.03, "m", "a wall away from its stated line not found, or a mallet's contacts taken for a wall's",
        "choice: a puck's radius",
    )  # fmt: skip
    wall_contacts: int = tuned(5, "contacts", "a wall's line set by chance", "choice: one or two cannot move a median")
    mallet_slack: float = tuned(
        0.008, "m", "contacts of a mallet with no cause", "choice: more than for a wall, since both places have errors"
    )
    mallet_clock: float = tuned(
        0.03, "s", "contacts with no cause if the mallet's clock differs from the camera's", "choice: four frames"
    )
    mallet_farthest: float = tuned(
        0.07,
        "m",
        "a fast mallet given every contact within its clock's error",
        "choice: a little more than a mallet's radius",
    )
    clearly_in: float = tuned(
        0.1,
        "m/s",
        "slow contacts and slides along a wall that determine its line",
        "choice: a slower contact may be noise or a slide",
    )
    clearly_out: float = tuned(0.05, "m/s", "the same after the contact", "choice: half of the speed before")
    touching: float = tuned(
        0.02, "m/s", "contacts of a wall that the puck leaves before or enters after", "choice: a fifth of clearly_in"
    )
    along_normal: float = tuned(
        0.5, "1", "contacts whose push is not along the line of centres (cosine)", "choice: 60 degrees"
    )
    gap_share: float = tuned(
        0.3, "1", "contacts between frames placed too far from their cause", "choice: the contact is within the gap"
    )
    slope_span: float = tuned(
        0.012, "s", "a mallet's rough velocity that is noise, or late", "choice: one and a half frames at 120 Hz"
    )
    wider_goal: float = tuned(
        0.06,
        "m",
        "a goal post taken for a wall where the goal's width is unknown",
        "choice: a third of the default goal's half, either side",
    )
    # events and velocity_jumps: the motion beside a contact
    side_frames: int = tuned(12, "frames", "a velocity that is noise, or no longer local", "choice: 0.1 s at 120 Hz")
    clean_frames: int = tuned(
        5, "frames", "velocities that few frames do not determine", "choice: two more than a parabola"
    )
    side_time: float = tuned(
        0.25, "s", "a brake that changes within the parabola beside a contact", "choice: 30 frames at 120 Hz"
    )
    side_most: int = tuned(36, "frames", "time spent on more frames than help", "choice: about side_time at 150 Hz")
    side_least: int = tuned(4, "frames", "a parabola through as many frames as it has numbers", "choice: one more")
    # mallet_path
    encoder_quantum: float = tuned(
        1e-5, "m", "an encoder's noise below the digits that it is written in", "choice: five digits of metres"
    )
    path_window: float = tuned(
        0.025, "s", "a velocity that is noise, or a plan's switches", "choice: five samples a side at 200 Hz"
    )
    path_samples: int = tuned(
        6, "samples", "a slow stream's fit with no freedom left", "choice: twice a parabola's numbers"
    )
    path_hole: float = tuned(0.05, "s", "a path drawn straight across missing samples", "choice: ten samples at 200 Hz")
    tuning_windows: int = tuned(
        48, "windows", "a jerk chosen by chance, or slowly", "choice: a second's work for a recording"
    )
    jerks: tuple[float, ...] = tuned(
        (1e1, 1e2, 1e3, 1e4, 1e5, 1e6),
        "m^2/s^5",
        "a gantry that jerks more or less than any candidate",
        "choice: decades",
    )
    switch_lags: tuple[float, ...] = tuned(
        tuple(0.002 * k for k in range(15)), "s", "switches that act later than any candidate", "choice: up to 28 ms"
    )
    switch_lags_between: tuple[float, ...] = tuned(
        tuple(0.0005 * k for k in range(-3, 4)),
        "s",
        "velocities of a mallet struck within a millisecond of a switch",
        "choice: as close as the board's ticks",
    )
    switch_step: float = tuned(
        80.0,
        "m/s^2",
        "a larger change of acceleration at a switch than the covariance allows",
        "choice: a typical size, not a limit",
    )
    contact_cost: float = tuned(
        6.0,
        "log likelihood",
        "windows with a contact that decide the jerk",
        "choice: some windows contain a contact of the mallet",
    )
    # clock_jumps
    clock_step: float = tuned(
        0.6, "periods", "jitter taken for a jump of the clock", "choice, held by test_clock_jumps.py"
    )
    beside_rows: int = tuned(
        5, "rows", "velocities that are noise, or a contact beside the step", "choice: 0.04 s at 120 Hz"
    )
    steady: float = tuned(
        0.2, "1", "a contact taken for a jump of the clock", "choice: more than glides brake within ten rows"
    )
    clear_jump: float = tuned(
        10.0, "standard deviations", "noise taken for a jump of the clock", "choice: white noise never reaches it"
    )
    clear_jump_least: float = tuned(
        0.004, "m", "a map's error taken for a jump of the clock", "choice: near the least jump of a place"
    )


SEGMENTATION = SegmentationNumbers()
