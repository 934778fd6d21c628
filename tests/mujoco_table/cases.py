"""Tables in MuJoCo and what each has beside the baseline law. The wall's law is never the baseline's: see `model`."""

from __future__ import annotations

from tests.mujoco_table.model import Settings

# name: the table, and the mechanisms that are really there, with their numbers
CASES: dict[str, tuple[Settings, dict[str, dict[str, float]]]] = {
    "plain": (Settings(), {"tangential_restitution": {"e_t": 1.0}}),
    "tilt": (
        Settings(tilt_x=0.02, tilt_y=-0.012),
        {"table_tilt": {"tilt_x": 0.02, "tilt_y": -0.012}, "tangential_restitution": {"e_t": 1.0}},
    ),
    "damping": (
        Settings(damping=0.1),
        {"linear_drag": {"k": 0.1}, "tangential_restitution": {"e_t": 1.0}},
    ),
    "wall_friction": (Settings(wall_mu=0.15), {"wall_friction_spin": {"mu": 0.15}}),
    "tilt_and_wall_friction": (
        Settings(wall_mu=0.15, tilt_x=-0.015, tilt_y=0.02),
        {"table_tilt": {"tilt_x": -0.015, "tilt_y": 0.02}, "wall_friction_spin": {"mu": 0.15}},
    ),
}
