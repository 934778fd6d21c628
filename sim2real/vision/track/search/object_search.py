"""Where in a picture one object is searched: where it is predicted, and then where it can be."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sim2real.vision.track.kalman_tracker import KalmanTracker
from sim2real.vision.track.search.parts import Region, SearchInParts
from sim2real.vision.track.search.regions import SearchRegions

ROOM = 4.0  # standard deviations of the prediction from the predicted place to the edge of a search region


@dataclass(frozen=True)
class ObjectSearch:
    """The search of one object.

    All times are of the picture [s]; `room` is from the object's place to the edge of its search region [m].
    """

    tracker: KalmanTracker
    regions: SearchRegions
    parts: SearchInParts

    def predicted(self, time: float, room: float) -> Region | None:
        """The region round the predicted place; None if that is unknown."""
        state = self.tracker.predict(time)
        return self.regions.around(state.place, room + ROOM * state.deviation) if state else None

    def likely(self, time: float, room: float) -> Iterator[Region]:
        """Regions to be searched one after the other, until the object is found: round its predicted place, and as far
        as it can have come from where it was measured only once."""
        regions = (self.predicted(time, room), None if self.tracker.confirmed else self._reachable(time, room))
        return (region for region in regions if region is not None)

    def possible(self, time: float, room: float) -> Region | None:
        """Where the object can be: within reach of a confirmed track, or anywhere, which is None."""
        return self._reachable(time, room) if self.tracker.confirmed else None

    def part(self, time: float, room: float, picture: int) -> Region:
        """The part of `possible` to be searched in a picture of this number."""
        return self.parts.part(self.possible(time, room), picture)

    def _reachable(self, time: float, room: float) -> Region | None:
        """As far as the object can have come since it was last measured; None if that is anywhere."""
        there = self.tracker.reachable(time)
        return there and self.regions.around(there[0], room + there[1])
