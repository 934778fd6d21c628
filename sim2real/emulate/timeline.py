"""Virtual time of the microcontroller in whole ticks, and the tick of the next event of each kind."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import inlined_kernel, kernel

PER_US = 576  # ticks per microsecond: a cycle at 8, 64 and 72 MHz is a whole number of ticks
NEVER = 1 << 62  # a tick that does not come
TICK_DUE, BYTE_COMES, PIECE_SENT, WATCHDOG_DUE = range(4)  # kinds of events
KINDS = 4

# now: only moves forward; due: tick of each kind's event; order: in which they were scheduled, for those of one tick
TIMELINE = np.dtype(
    [("now", np.int64), ("due", np.int64, KINDS), ("order", np.int64, KINDS), ("count", np.int64)], align=True
)


@kernel
def clear_timeline(timeline):
    """Cancel all events; time is kept."""
    for kind in range(KINDS):
        timeline.due[kind] = NEVER


@inlined_kernel
def schedule(timeline, kind, tick):
    """Let an event come at `tick`, at once if that is past, in place of the one of its kind."""
    timeline.count += 1
    timeline.due[kind] = max(tick, timeline.now)
    timeline.order[kind] = timeline.count


@inlined_kernel
def drop(timeline, kind):
    """Cancel an event; nothing if there is none."""
    timeline.due[kind] = NEVER


@inlined_kernel
def next_kind(timeline):
    """The kind of the event that comes next; its tick is NEVER if there is none."""
    first = 0
    for kind in range(1, KINDS):
        due, best = timeline.due[kind], timeline.due[first]
        if due < best or (due == best and timeline.order[kind] < timeline.order[first]):
            first = kind
    return first


@inlined_kernel
def next_tick(timeline):
    """The tick of the next event, NEVER if there is none."""
    return timeline.due[next_kind(timeline)]
