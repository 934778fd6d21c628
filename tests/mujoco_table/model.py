"""A puck on a table, in MuJoCo.

What MuJoCo computes (its manual, chapter "Computation"): the puck is a body with three slides and a hinge about the
vertical. It stands on the floor by one point on its axis, with an elliptic friction cone: sliding friction mu g against
the velocity, in all directions alike, that spin does not change. Its rim is a sphere that meets the walls' boxes: a
spring and a damper along the normal, and Coulomb friction at the rim, which spins the puck. The tilt is a gravity that
is not quite vertical; linear drag and the decay of spin are damped joints. There is no drag by v^2.

MuJoCo's friction is not quite Coulomb's: it stops the rim within a time (SLIP) that is not short beside the hit, its
convex cone lets slip change the normal force by a few per cent, and it is never less than 1e-5 of the load.

So, beside the baseline law: a tangent speed at the walls that is kept whole (without friction there) or loses what
friction takes, never the share e; and restitution that is constant, as a linear spring and damper have it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

GRAVITY = 9.81  # m/s^2
MASS = 0.03  # kg
DEEP = 0.2  # m, of the walls' boxes
TOUCH = 0.0015  # s, for which a hit lasts
SLIP = 1e-3  # s, time constant in which friction would stop the rim
STEP = 2e-5  # s, 75 of them in a hit


@dataclass(frozen=True)
class Settings:
    """Numbers of a table, in SI units."""

    length: float = 2.0
    width: float = 1.0
    goal_width: float = 0.32
    puck_radius: float = 0.0309
    friction: float = 0.125  # m/s^2
    restitution: float = 0.8
    wall_mu: float = 0.0
    tilt_x: float = 0.0  # m/s^2
    tilt_y: float = 0.0
    damping: float = 0.0  # 1/s, linear drag
    spin_decay: float = 0.3  # 1/s


def spring_and_damper(restitution: float) -> tuple[float, float]:
    """Stiffness and damping per unit mass of a contact that lasts TOUCH and gives back `restitution` of the speed.

    A damped oscillator leaves after half a period pi / w with exp(-decay pi / w) of its speed.
    """
    w = pi / TOUCH
    decay = -log(restitution) / TOUCH
    return w * w + decay * decay, 2.0 * decay


def xml(s: Settings) -> str:
    """The model's description in MJCF."""
    stiffness, damping = spring_and_damper(s.restitution)
    r, inertia = s.puck_radius, 0.5 * MASS * s.puck_radius**2
    walls = boxes(s)
    vertical = sqrt(GRAVITY**2 - s.tilt_x**2 - s.tilt_y**2)
    # The impedance 1 makes the contact's spring and damper what they are called: acceleration per depth and speed.
    hard = f'solref="{-stiffness} {-damping}" solreffriction="{SLIP} 1" solimp="0.9999 0.9999 0.001" condim="3"'
    geoms = "\n".join(
        f'<geom name="{name}" type="box" pos="{x} {y} {r}" size="{a} {b} {r}" contype="0" conaffinity="0"/>'
        for name, (x, y, a, b) in walls.items()
    )
    pairs = "\n".join(
        f'<pair geom1="rim" geom2="{name}" {hard} friction="{s.wall_mu} {s.wall_mu} 0 0 0"/>' for name in walls
    )
    mu = s.friction / vertical
    return f"""
<mujoco>
 <option timestep="{STEP}" gravity="{s.tilt_x} {s.tilt_y} {-vertical}" cone="elliptic"/>
 <worldbody>
  <geom name="floor" type="plane" size="5 5 1" contype="0" conaffinity="0"/>
  {geoms}
  <body name="puck" pos="0 0 {r}">
   <inertial pos="0 0 0" mass="{MASS}" diaginertia="{inertia} {inertia} {inertia}"/>
   <joint type="slide" axis="1 0 0" damping="{MASS * s.damping}"/>
   <joint type="slide" axis="0 1 0" damping="{MASS * s.damping}"/>
   <joint type="slide" axis="0 0 1"/>
   <joint type="hinge" axis="0 0 1" damping="{inertia * s.spin_decay}"/>
   <geom name="rim" type="sphere" size="{r}" contype="0" conaffinity="0"/>
   <geom name="foot" type="sphere" size="{0.1 * r}" pos="0 0 {-0.9 * r}" contype="0" conaffinity="0"/>
  </body>
 </worldbody>
 <contact>
  <pair geom1="foot" geom2="floor" condim="3" friction="{mu} {mu} 0 0 0"/>
  {pairs}
 </contact>
</mujoco>"""


def boxes(s: Settings) -> dict[str, tuple[float, float, float, float]]:
    """Walls as boxes (middle x, y, half sizes): two long ones, and the short ones on both sides of the mouths."""
    beside, half = 0.5 * (s.width - s.goal_width), 0.5 * DEEP
    found = {
        "y0": (0.5 * s.length, -half, 0.5 * s.length + DEEP, half),
        "y1": (0.5 * s.length, s.width + half, 0.5 * s.length + DEEP, half),
    }
    for name, x in (("x0", -half), ("x1", s.length + half)):
        found[f"{name}y0"] = (x, 0.5 * beside, half, 0.5 * beside)
        found[f"{name}y1"] = (x, s.width - 0.5 * beside, half, 0.5 * beside)
    return found
