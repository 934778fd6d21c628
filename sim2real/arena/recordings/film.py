"""A film of a part of a recording: what was seen, and the simulator's prediction of each glide in orange."""

from __future__ import annotations

import json
import math
import sys
from bisect import bisect_right
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.rendering import canvas
from puckpilot_env.rendering.canvas import Picture
from puckpilot_env.rendering.drawing import draw
from puckpilot_env.rendering.film import TRAIL_TIME, Video
from puckpilot_env.rendering.rink import PLAYERS, layout
from puckpilot_env.rendering.video import VideoWriter
from puckpilot_env.variants import find_variant
from sim2real.table.game.game_record import GameRecord

FPS = 30.0
SCALE, WIDEST = 200.0, 800.0  # pixels a metre, and of a table's length at most
LONGEST_GAP = 0.1  # s between rows over which nothing is drawn
FARTHEST = 0.25  # m between two rows; what went farther was placed anew
NAMES = "robot", "opponent"
OUTSIDE = (-100.0, -100.0)  # m, of what is not known: out of the picture
PREDICTED = PLAYERS[1]
Place = tuple[float, float]


def place_at(track: dict[str, Any], time: float) -> Place | None:
    """Where a track of times `t` [s] and `place`s [m] is at a time; None where it was not seen."""
    times, places = track["t"], track["place"]
    k = bisect_right(times, time) - 1
    if k < 0 or places[k] is None:
        return None
    (x, y), after = places[k], places[k + 1] if k + 1 < len(times) else None
    if after is None or times[k + 1] - times[k] > LONGEST_GAP or math.dist((x, y), after) > FARTHEST:
        return (x, y) if time - times[k] < LONGEST_GAP else None
    share = (time - times[k]) / (times[k + 1] - times[k])
    return x + share * (after[0] - x), y + share * (after[1] - y)


class RecordingFilm:
    """Pictures of a recording, whose `content` is that of its page; see `replay.replay_of`. ValueError, in one line,
    for a table of an impossible size."""

    def __init__(self, content: dict[str, Any]) -> None:
        self._content, sizes = content, content["table"]
        self._game = GameRecord("match-v0", sizes)
        self._rules = find_variant("defence-v0").rules()[0]  # of which no score is shown, but the time
        self._layout = layout(self._game.p, min(SCALE, WIDEST / sizes["length"]))

    def write(self, video: Video, begin: float, end: float) -> None:
        """Add the pictures from `begin` to `end` [s], or to the end of the recording. ValueError, in one line, where
        that is before."""
        tracks = (self._content["puck"], *self._content["mallets"])
        length = max((track["t"][-1] for track in tracks if track["t"]), default=0.0)
        if begin > length:
            raise ValueError(f"from {begin:g} s; the recording ends at {length:g} s")
        end = min(end, length)
        for number in range(math.floor((end - begin) * video.fps + 1e-6) + 1):
            video.add(self.picture(begin + number / video.fps))

    def picture(self, time: float) -> Picture:
        """The picture (h, w, 3) uint8 of a moment [s]."""
        record, p, puck = self._game.record, self._game.p, place_at(self._content["puck"], time)
        self._game.put_puck((*(puck or OUTSIDE), 0.0, 0.0))
        for which, track in enumerate(self._content["mallets"]):
            self._game.put_mallet(which, (*(place_at(track, time) or OUTSIDE), 0.0, 0.0))
        record["time"] = time
        record["defending"] = (puck or OUTSIDE)[0] < 0.5 * p["length"], (puck or OUTSIDE)[0] >= 0.5 * p["length"]
        picture = draw(
            record, p, scale=self._layout.scale, names=NAMES, trail=self._trail(time), rules=self._rules,
        )  # fmt: skip
        self._predict(picture, time)
        return picture

    def _trail(self, time: float) -> np.ndarray:
        """Where the puck was in the last moments, since it was not seen, or placed anew."""
        times, places = self._content["puck"]["t"], self._content["puck"]["place"]
        last = bisect_right(times, time)
        found: list[Place] = []
        for k in range(last - 1, -1, -1):
            if times[k] < time - TRAIL_TIME or places[k] is None:
                break
            if found and math.dist(places[k], found[-1]) > FARTHEST:
                break
            found.append(places[k])
        return np.array(found[::-1]).reshape(-1, 2)

    def _predict(self, picture: Picture, time: float) -> None:
        """Draw the prediction of the glide that goes on, and where it has the puck."""
        for glide in self._content["glides"]:
            if glide["t"][0] <= time <= glide["t"][-1]:
                points = np.stack(self._layout.pixel(*np.array(glide["path"]).T), axis=1)
                canvas.trail(picture, points, 0.006 * self._layout.scale, PREDICTED, 0.6)
                where = place_at({"t": glide["t"], "place": glide["path"]}, time)
                if where is not None:
                    radius = self._content["table"]["puck_radius"] * self._layout.scale
                    canvas.disc(picture, *self._layout.pixel(*where), 0.45 * radius, PREDICTED)


def main() -> int:
    """Write a film of the content at the standard input, for the server's process: from, to [s], file. 2: it cannot be
    made, and one line says why."""
    begin, end, file = float(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3])
    try:
        film = RecordingFilm(json.load(sys.stdin))
        with VideoWriter(file, FPS) as video:
            film.write(video, begin, end)
    except (ValueError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
