"""The flashed program at play, interrupted between any two blocks of its code, until so many came in the middle of
something: `python -m tests.sim2real.emulate.preempted 100000` (hours)."""

from __future__ import annotations

import itertools
import sys

from sim2real.link.messages import Ping, State, Telemetry
from tests.firmware.line import frame
from tests.sim2real.emulate.robot import Robot


def play(preemptions: int, seed: int) -> int:
    """Play back and forth with one seed until so many; how many there were. AssertionError where anything went wrong:
    a frame damaged, a byte or a telemetry lost, a fault, or a mallet off its path."""
    robot = Robot(fuzz=seed)
    counted = [0]
    enter = robot.machine.cpu.enter

    def count(number: int) -> None:
        counted[0] += not robot.machine.cpu.asleep
        enter(number)

    robot.machine.cpu.enter = count  # pyright: ignore[reportAttributeAccessIssue]
    robot.armed()
    for target in itertools.cycle([(0.5, 0.6), (0.8, 0.3), (0.2, 0.8), (0.1, 0.2)]):
        robot.sends(target)
        told = [one for one in robot.run(700_000) if isinstance(one, Telemetry)]
        for before, after in itertools.pairwise(told):
            assert after.time - before.time == 2000
            assert max(abs(a - b) for a, b in zip(after.place, after.path, strict=True)) < 2e-3
        last = told[-1]
        assert (last.state, last.damaged, last.lost) == (State.ARMED, 0, 0)
        if counted[0] >= preemptions:
            return counted[0]
        robot.machine.send(frame(Ping(1)))
    raise AssertionError


def main() -> int:
    wanted, done, seed = int(sys.argv[1]), 0, 0
    while done < wanted:
        seed += 1
        done += play(min(wanted - done, 2_000), seed)
        print(f"{done:,} interrupts in the middle of something, {seed} seeds, clean", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
