"""A session with a fake board, in simulated time."""

from __future__ import annotations

from sim2real.link.session import Session
from sim2real.link.wire.messages import Config, Traj
from tests.sim2real.link.fake_board import Bench, FakeBoard

CONFIGURED = (
    (1e-3, 1e-3), (1e-2, 1e-2), (0.5, 0.5), 0.03, 24.0, 12.0, (0.0, 1.0), (0.0, 1.0), (1.0, 1.0), (1.0, 1.0),
    (1.0, 1.0), 0.1,
)  # fmt: skip
CONFIG_SENT = Config(*CONFIGURED, silence=100, command_delay=0)
PLAN = Traj(0, 1000, 50_000, (12.0, -6.5), (1, 2), (3, 4), (0.5, 0.25), (-0.5, 0.125), (0.0, 0.0009765625))


def run(bench: Bench, session: Session, seconds: float) -> None:
    end = bench.time + seconds
    while bench.time < end:
        before = bench.time
        session.poll()
        if bench.time == before:  # no port, so no read that takes time
            bench.time += 0.001


def met(board: FakeBoard | None = None) -> tuple[Bench, Session, FakeBoard]:
    bench = Bench(board or FakeBoard())
    session = Session(bench.connect, bench.now)
    run(bench, session, 0.1)
    return bench, session, bench.board
