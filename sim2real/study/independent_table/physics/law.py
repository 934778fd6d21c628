"""The law of the reference table: all parameters, and all effects that the baseline does not contain.

The first block repeats names and defaults of the simulator's parameters on purpose, because the reference shares no
code with what it checks. The other blocks are effects: each is off at its default, and exactly one function, named
beside it, reads it. The last blocks are unlisted laws: `unlisted.LAWS` states what each depends on.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np


@dataclass(frozen=True)
class Law:
    """Parameters in SI units; `None` means "as the baseline"."""

    # Baseline: the report's sections 2.3, E, F, G.
    length: float = 2.0
    width: float = 1.0
    goal_width: float = 0.32
    puck_radius: float = 0.0309
    mallet_radius: float = 0.0505
    friction: float = 0.125
    drag: float = 0.125
    wall_restitution: float = 0.7
    mallet_restitution: float = 0.7
    pulley_radius: float = 0.035306
    max_voltage: float = 24.0
    a1: float = 3.579e-6
    a2: float = 0.00571
    a3: float = 0.05315
    b1: float = -1.7165e-6
    b2: float = -0.002739
    b3: float = 0.0

    # Glide: `puck.push` and `puck.grip`.
    tilt_x: float = 0.0  # m/s^2, constant acceleration
    tilt_y: float = 0.0
    warp_xx: float = 0.0  # 1/s^2, acceleration -warp (position - middle of the table)
    warp_yy: float = 0.0
    warp_xy: float = 0.0
    linear_drag: float = 0.0  # 1/s, -k v
    side_force: float = 0.0  # 1/s, acceleration k across the velocity, to its left
    spin_side_force: float = 0.0  # 1, acceleration c spin v across the velocity (Magnus)
    patch_x: float = 0.0  # m, a disc of other friction
    patch_y: float = 0.0
    patch_radius: float = 0.0
    patch_friction: float = 0.0  # m/s^2, extra inside the disc
    friction_drift: float = 0.0  # 1/s, friction (1 + rate t)
    friction_anisotropy: float = 0.0  # 1, friction (1 + ratio (vx^2 - vy^2) / v^2)
    friction_ratio: float = 1.0  # 1, x:y; friction is the vector -friction (sqrt(ratio) vx, vy / sqrt(ratio)) / v

    # Walls and posts: `bounce.off_wall`.
    wall_spin: bool = False  # Coulomb impulse with a carried spin, instead of e v_t
    wall_mu: float = 0.15  # 1, its friction coefficient
    spin_inertia: float = 0.5  # 1, kappa in I = kappa m r^2 (1/2: a full disc)
    spin_decay: float = 0.5  # 1/s, spin' = -k spin; `puck.advance_puck`
    restitution_slope: float = 0.0  # s/m, e - slope |v_n|
    restitution_power: float = 0.0  # 1, e |v_n / (1 m/s)|^-power, no more than 1
    tangential_restitution: float | None = None  # 1
    post_restitution: float | None = None  # 1
    odd_wall: int = -1  # 0..3: x0, xL, y0, yW
    odd_wall_extra: float = 0.0  # 1, its restitution minus the others'

    # Walls that are not where the drawing has them: `table.wall_line`. Displacement [m] of each along its axis at its
    # middle, and slope [1]: by how much more for each metre along it.
    wall_offset_x0: float = 0.0
    wall_offset_x1: float = 0.0
    wall_offset_y0: float = 0.0
    wall_offset_y1: float = 0.0
    wall_slope_x0: float = 0.0
    wall_slope_x1: float = 0.0
    wall_slope_y0: float = 0.0
    wall_slope_y1: float = 0.0

    # Mallets: `bounce.off_mallet`.
    mallet_restitution_slope: float = 0.0  # s/m
    mallet_mu: float = 0.0  # 1, Coulomb impulse along the rim
    mallet_give: float = 0.0  # 1, puck mass / effective mallet mass

    # Gantry: `volts.at_the_motors` and, for the delay, `volts.sorted_changes`.
    voltage_sag: float = 0.0  # 1/V, V / (1 + sag (|Vx| + |Vy|)), with a plan's two volts however long each lasts
    deadband: float = 0.0  # V lost to stiction
    command_delay: float = 0.0  # s

    # Between motor and mallet: `gantry.follow`; at most one of the two.
    belt_hz: float = 0.0  # Hz, a spring and a damper: m'' = w^2 (p - m) + 2 zeta w (p' - m'), w = 2 pi hz
    belt_zeta: float = 0.0  # 1
    backlash: float = 0.0  # m, the mallet stays while the motor is within half of it

    # Sensing: `camera.see`.
    camera_delay: float = 0.0  # s, a frame stamped t shows the table at t - delay
    camera_clock: float = 0.0  # 1, the camera's clock runs fast by this fraction
    camera_scale_x: float = 0.0  # 1, seen x = (1 + scale) x + shear y
    camera_scale_y: float = 0.0
    camera_shear: float = 0.0
    encoder_clock: float = 0.0  # 1, the clock of mallet.csv and drive.csv runs fast by this; `record.make_recording`

    # Unlisted laws. Glide: `strange.pull` and `strange.rub`.
    vortex: float = 0.0  # m/s^2, greatest pull round a point (at `vortex_size` from it)
    vortex_x: float = 1.0  # m
    vortex_y: float = 0.5
    vortex_size: float = 0.25  # m
    washboard: float = 0.0  # m/s^2, pull sin(2 pi x / length) along x
    washboard_length: float = 0.4  # m
    tilt_drift_x: float = 0.0  # m/s^3, a tilt that grows with time, level at `tilt_drift_from`
    tilt_drift_y: float = 0.0
    tilt_drift_from: float = 0.0  # s
    cubic_drag: float = 0.0  # s/m^2, -c v^3
    slow_friction: float = 0.0  # m/s^2, more friction, times exp(-v / slow_speed)
    slow_speed: float = 0.3  # m/s
    breathing: float = 0.0  # 1, friction (1 + a sin(2 pi t / period))
    breathing_period: float = 10.0  # s
    grain: float = 0.0  # 1, friction (1 + a cos 4 heading)
    nap: float = 0.0  # 1, friction (1 + a cos(heading - nap_heading)), as on velvet
    nap_heading: float = 0.0  # rad
    fading: float = 0.0  # m/s^2, more friction, times exp(-(time since the last contact) / fading_time)
    fading_time: float = 0.3  # s
    stripe: float = 0.0  # m/s^2, more friction where |x - stripe_x| < stripe_width / 2
    stripe_x: float = 1.0  # m
    stripe_width: float = 0.3  # m
    push_x: float = 0.0  # m/s^2, a pull that lasts from `push_from` to `push_until`
    push_y: float = 0.0
    push_from: float = 0.0  # s
    push_until: float = 0.0  # s
    pulse: float = 0.0  # 1, friction (1 + a) in the first half of every period
    pulse_period: float = 6.0  # s

    # Walls and mallets: `bounce.off_wall`, `bounce.off_mallet`.
    wall_wave: float = 0.0  # 1, e + a sin(2 pi s / length) at s metres along the wall
    wall_wave_length: float = 0.5  # m
    wall_warming: float = 0.0  # 1/s, e + rate t
    mallet_warming: float = 0.0  # 1/s, the same at the mallets
    stretch_wall: int = -1  # 0..3: x0, xL, y0, yW
    stretch_extra: float = 0.0  # 1, its restitution from `stretch_from` to `stretch_until` minus that elsewhere
    stretch_from: float = 0.0  # m along the wall
    stretch_until: float = 0.0  # m

    motor_friction_left: float = 0.0  # V, against the motion of the left motor's belt, x - y
    motor_friction_right: float = 0.0  # V, against that of the right one's, -x - y
    axis_friction_x: float = 0.0  # V, against the motion of an axis
    axis_friction_y: float = 0.0

    # Gantry: `gantry.loss`.
    rough: float = 0.0  # 1, speed loss C7 (1 + a sin(2 pi position / length)) on both axes
    rough_length: float = 0.3  # m
    cubic_loss: float = 0.0  # s^2/m^2, speed loss C7 (1 + c v^2)

    # Who has the second mallet: `gantry.advance_mallets`, `bounce.off_mallet`.
    hand: bool = False  # a hand, whom nothing hinders that is written of mallets and gantries above

    def numbers(self) -> np.record:
        """The same fields as one record of floats, which the compiled functions read by name (None becomes NaN)."""
        values = [getattr(self, field.name) for field in fields(self)]
        row = tuple(float("nan") if value is None else float(value) for value in values)
        return np.rec.array([row], dtype=[(field.name, np.float64) for field in fields(self)])[0]
