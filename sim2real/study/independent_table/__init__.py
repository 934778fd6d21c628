"""An independent air hockey table in small fixed steps: the oracle for the event-driven physics.

It shares no code with what it checks, and with the product only the decorators that keep what was compiled.

    law = Law(tilt_x=0.02)
    trace = run(law, puck=(1.0, 0.5, -2.0, 0.3), mallets=[(0.3, 0.5)], plans=[(8.0, 0.0, 0.1, 0.0, 0.15, 0.0)])
    trace.puck[-1], trace.contacts

The path of one step: `volts` (plans as voltages) -> `march` (the loop) -> `gantry` and `puck` (motion) -> `table`
(gaps) -> `bounce` (impulses). `law` holds every number. `record` writes a recording by a simulated camera.
"""

from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.simulate import Contact, Trace, run

__all__ = ["Contact", "Law", "Trace", "run"]
