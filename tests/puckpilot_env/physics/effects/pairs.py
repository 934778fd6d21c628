"""The same piece of physics in both worlds: parameters of the simulator beside the law of the reference."""

from __future__ import annotations

from puckpilot_env.physics.effects import unlisted_blow, unlisted_bounce
from puckpilot_env.physics.effects.unlisted_bounce import BY_SPEED, BY_TIME, OF_BOTH, OF_NORMAL
from sim2real.study.independent_table import Law

Pair = tuple[dict[str, float], Law]


def bounce_table(kind: int, share: int, *values: float) -> dict[str, float]:
    """Parameters of `unlisted_bounce`; numbers that are not given are 0."""
    return dict(zip(unlisted_bounce.EFFECT.row_names, [float(kind), float(share), *values], strict=False))


def blow_table(kind: int, share: int, *values: float) -> dict[str, float]:
    """Parameters of `unlisted_blow`."""
    return dict(zip(unlisted_blow.EFFECT.row_names, [float(kind), float(share), *values], strict=True))


# Places are relative to the middle of the table where they matter; the reference names some numbers otherwise.
GLIDE: dict[str, Pair] = {
    "table_tilt": ({"tilt_x": 0.12, "tilt_y": -0.08}, Law(tilt_x=0.12, tilt_y=-0.08)),
    "table_warp": (
        {"warp_xx": 0.5, "warp_yy": -0.3, "warp_xy": 0.2},
        Law(warp_xx=0.5, warp_yy=-0.3, warp_xy=0.2),
    ),
    "linear_drag": ({"linear_drag": 0.8}, Law(linear_drag=0.8)),
    "friction_patch": (
        {"patch_x": 1.0, "patch_y": 0.5, "patch_radius": 0.3, "patch_extra": 0.4},
        Law(patch_x=1.0, patch_y=0.5, patch_radius=0.3, patch_friction=0.4),
    ),
    "air_drift": ({"air_drift": 0.05}, Law(friction_drift=0.05)),
    "friction_anisotropy": ({"friction_anisotropy": 0.5}, Law(friction_anisotropy=0.5)),
    "friction of two components": (  # 0.125 (1 + 0.28) = 0.16 along x and 0.125 (1 - 0.28) = 0.09 along y
        {"friction_anisotropy": 0.28, "friction_turning": 0.28},
        Law(friction=0.12, friction_ratio=16 / 9),
    ),
    "side_force": ({"side_force": 0.8}, Law(side_force=0.8)),
    "side_force with spin": ({"spin_side_force": 0.02}, Law(spin_side_force=0.02)),
    "several": (
        {"tilt_x": 0.05, "warp_yy": 0.3, "linear_drag": 0.3, "side_force": -0.4, "air_drift": 0.02},
        Law(tilt_x=0.05, warp_yy=0.3, linear_drag=0.3, side_force=-0.4, friction_drift=0.02),
    ),
}
CONTACTS: dict[str, Pair] = {
    "table_tilt": ({"tilt_x": 0.2, "tilt_y": -0.15}, Law(tilt_x=0.2, tilt_y=-0.15)),
    "table_warp": ({"warp_xx": 0.5, "warp_yy": 0.8}, Law(warp_xx=0.5, warp_yy=0.8)),
    "side_force": ({"side_force": 0.8}, Law(side_force=0.8)),
    "speed_dependent_restitution": ({"restitution_slope": 0.05}, Law(restitution_slope=0.05)),
    "speed_dependent_restitution by a power": ({"restitution_power": 0.15}, Law(restitution_power=0.15)),
    "tangential_restitution": ({"tangential_ratio": 9 / 7}, Law(tangential_restitution=0.9)),
    "tangential_restitution, and the normal one falls": (
        {"tangential_ratio": 9 / 7, "restitution_slope": 0.05},
        Law(tangential_restitution=0.9, restitution_slope=0.05),
    ),
    "wall_friction_spin": ({"wall_mu": 0.15}, Law(wall_spin=True, wall_mu=0.15)),
    "wall_friction_spin, a heavy rim, and a spin that pulls": (
        {"wall_mu": 0.3, "spin_inertia": 0.9, "spin_decay": 2.0, "spin_side_force": 0.01},
        Law(wall_spin=True, wall_mu=0.3, spin_inertia=0.9, spin_decay=2.0, spin_side_force=0.01),
    ),
    "wall_to_wall_restitution": ({"restitution_y1": -0.2}, Law(odd_wall=3, odd_wall_extra=-0.2)),
    "wall_to_wall_restitution at an end": ({"restitution_x0": 0.1}, Law(odd_wall=0, odd_wall_extra=0.1)),
    "corner_restitution": ({"post_extra": -0.3}, Law(post_restitution=0.4)),
    "unlisted_bounce": (
        bounce_table(BY_SPEED, OF_BOTH, 0.0, 2.0, 4.0, 6.0, 14.0, 0.0, -0.1, -0.2, -0.3, -0.7),
        Law(restitution_slope=0.05),
    ),
    "unlisted_bounce of the normal speed alone": (
        bounce_table(BY_SPEED, OF_NORMAL, 0.0, 2.0, 4.0, 6.0, 14.0, 0.1, 0.0, -0.1, -0.2, -0.6),
        Law(wall_restitution=0.8, restitution_slope=0.05, tangential_restitution=0.7),
    ),
    "unlisted_bounce by time": (
        bounce_table(BY_TIME, OF_BOTH, 0.0, 0.25, 0.5, 0.75, 1.0, 0.0, -0.1, -0.2, -0.3, -0.4),
        Law(wall_warming=-0.4),
    ),
    "mallet_speed_restitution": ({"mallet_restitution_slope": 0.06}, Law(mallet_restitution_slope=0.06)),
    "mallet_friction": ({"mallet_mu": 0.2}, Law(mallet_mu=0.2)),
    "mallet_give": ({"mallet_give": 0.15}, Law(mallet_give=0.15)),
    "unlisted_blow": (
        blow_table(unlisted_blow.BY_SPEED, OF_NORMAL, 0.0, 2.0, 4.0, 8.0, 0.0, -0.12, -0.24, -0.48),
        Law(mallet_restitution_slope=0.06),
    ),
    "unlisted_blow by time": (
        blow_table(unlisted_blow.BY_TIME, OF_NORMAL, 0.0, 0.25, 0.5, 1.0, 0.0, -0.1, -0.2, -0.4),
        Law(mallet_warming=-0.4),
    ),
}
