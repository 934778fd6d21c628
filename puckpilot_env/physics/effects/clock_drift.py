"""The clock of one stream runs fast against the others': the encoders' here, the camera's where blows show it."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "crystals of two computers: tens of ppm; a wrong divider: thousands"

EFFECT = Effect(
    regime="sensing",
    law="a row of the stream is stamped t (1 + 1e-6 ppm), with t on the other streams' clock",
    rows={
        "ppm": Parameter("encoder_clock", "ppm", 0.0, -5000.0, 5000.0, "by which the encoders' clock is fast", _SOURCE)
    },
    depends_on=("time",),
    excited_by="a mallet that moves all the time, for minutes, with plans and encoders stamped by their own clocks",
    source="two clocks that were set alike once",
    not_simulated="players see what has arrived, however it is stamped, and the simulator has one clock",
)


@kernel
def pace(p):
    """Seconds of the encoders' clock for each second of the plans'."""
    return 1.0 + 1e-6 * p.encoder_clock
