"""A picture of a table: `draw`. What `rgb_array` renders, what films and documentation pages are made of."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.batch.motion import mallet_motion, puck_motion
from puckpilot_env.batch.trace import trace as trace_motion
from puckpilot_env.game.start import MATCH
from puckpilot_env.rendering import canvas
from puckpilot_env.rendering.canvas import Picture
from puckpilot_env.rendering.rink import (
    ICE,
    INK,
    MUTED,
    PLAYERS,
    PUCK,
    PUCK_RING,
    RAIL_WIDTH,
    SCALE,
    Layout,
    background,
    layout,
    mix,
)
from puckpilot_env.tables import Tables
from puckpilot_env.variants import Variant


def draw(
    table: np.void,
    p: np.void,
    *,
    scale: float = SCALE,
    names: Sequence[str] = ("player_0", "player_1"),
    trail: ArrayLike | None = None,
    rules: np.void | None = None,
    note: str | None = None,
) -> Picture:
    """A picture (h, w, 3) uint8 of one table, x to the right and y upwards.

    table: a `state.TABLE` record; p: its parameters; scale: pixels a metre; trail: where the puck was (m, 2) [m],
    oldest first; rules: a `rules.RULES` record, by which a match shows score and time left, and a drill the time since
    it began; note: a word in place of the time.
    """
    place = layout(p, scale)
    picture = background(place).copy()
    if trail is not None and np.size(trail):
        _draw_trail(picture, place, np.asarray(trail, np.float64), p)
    mallets = mallet_motion(table)[:, :2]
    for k in range(2):
        _draw_beam(picture, place, mallets[k, 0], p, k)
    _draw_puck(picture, place, puck_motion(table), p)
    for k in range(2):
        _draw_mallet(picture, place, mallets[k], p, k)
    _draw_header(picture, place, table, names, rules, note)
    return picture


def draw_start(variant: Variant, *, seed: int = 0, steps: int = 5, scale: float = SCALE) -> Picture:
    """A picture (h, w, 3) uint8 of how an episode of a variant may begin: the puck's way through its first steps.

    The mallets move to random places, at half of the highest voltage; the same `seed` gives the same picture.
    """
    tables = Tables(variant, 1, seed=seed, autoreset=False)
    random = np.random.default_rng(seed)
    low, high = tables.action_bounds
    times = np.linspace(0.0, tables.variant.period, 21)
    moment, trail = tables.states[0].copy(), [puck_motion(tables.states[0])[:2]]
    for _ in range(steps):
        actions = random.uniform(low, high, (1, 2, 4)).astype(np.float32)
        actions[..., 2:] = 0.5 * high[2:]
        moments, scored = trace_motion(tables, 0, actions[0], times)
        trail.extend(puck_motion(moments)[:, :2])
        moment = moments[-1]
        tables.step(actions)
        if scored[-1] or tables.terminated[0] or tables.truncated[0]:
            break
    return draw(moment, tables.params[0], scale=scale, trail=trail, rules=variant.rules()[0])


def _draw_trail(picture: Picture, place: Layout, trail: NDArray[np.float64], p: np.void) -> None:
    x, y = place.pixel(trail[:, 0], trail[:, 1])
    points = np.stack([x, y], axis=1)
    far = np.hypot(*np.diff(points[::-1], axis=0).T).cumsum()  # from the newest point back
    _, kept = np.unique(np.floor(np.concatenate([[0.0], far]) / 5.0), return_index=True)
    canvas.trail(picture, points[::-1][kept][::-1], 0.8 * p["puck_radius"] * place.scale, PUCK, 0.3)


def _draw_beam(picture: Picture, place: Layout, x: float, p: np.void, player: int) -> None:
    """The gantry beam over the player's mallet, resting on both rails."""
    middle, top = place.pixel(x, place.width)
    bottom = place.pixel(x, 0.0)[1]
    half, rail = max(0.5 * p["beam_width"] * place.scale, 1.0), 0.7 * RAIL_WIDTH * place.scale
    colour = PLAYERS[player]
    canvas.box(picture, middle - half, top, middle + half, bottom, colour, 0.13)
    edge = 0.004 * place.scale
    for x_edge in (middle - half, middle + half - edge):
        canvas.box(picture, x_edge, top, x_edge + edge, bottom, colour, 0.18)
    for end in (top - rail, bottom):
        canvas.box(picture, middle - half, end, middle + half, end + rail, colour, 0.75)


def _draw_puck(picture: Picture, place: Layout, puck: NDArray[np.float64], p: np.void) -> None:
    x, y = place.pixel(puck[0], puck[1])
    radius = p["puck_radius"] * place.scale
    canvas.disc(picture, x, y + 0.12 * radius, 1.1 * radius, INK, 0.25, 0.5 * radius)
    canvas.disc(picture, x, y, radius, PUCK)
    canvas.disc(picture, x, y, 0.66 * radius, PUCK_RING)
    canvas.disc(picture, x, y, 0.52 * radius, PUCK)


def _draw_mallet(picture: Picture, place: Layout, mallet: NDArray[np.float64], p: np.void, player: int) -> None:
    x, y = place.pixel(mallet[0], mallet[1])
    radius, colour = p["mallet_radius"] * place.scale, PLAYERS[player]
    canvas.disc(picture, x, y + 0.1 * radius, 1.08 * radius, INK, 0.3, 0.4 * radius)
    canvas.disc(picture, x, y, radius, mix(colour, INK, 0.12))
    canvas.disc(picture, x, y, 0.86 * radius, colour)
    canvas.disc(picture, x, y, 0.66 * radius, mix(colour, ICE, 0.22))
    canvas.disc(picture, x, y + 0.06 * radius, 0.44 * radius, INK, 0.3, 0.3 * radius)
    canvas.disc(picture, x, y, 0.4 * radius, colour)
    x, y = x - 0.06 * radius, y - 0.08 * radius
    canvas.disc(picture, x, y, 0.2 * radius, mix(colour, ICE, 0.35), 0.8, 0.25 * radius)


def _draw_header(
    picture: Picture, place: Layout, table: np.void, names: Sequence[str], rules: np.void | None, note: str | None
) -> None:
    """Names, who defends, score and time."""
    unit = place.scale / SCALE
    middle, _ = place.pixel(0.5 * place.length, 0.0)
    time_left = rules["match_time"] - table["time"] if rules is not None and rules["game"] == MATCH else None
    has_score = rules is None or time_left is not None
    room = middle - place.pixel(0.0, 0.0)[0] - 50 * unit
    for k in range(2):
        _draw_name(picture, place, names[k], "defends" if table["defending"][k] else "attacks", k, room)
    small = max(round(12 * unit), 6)
    if has_score:
        big = max(round(21 * unit), 8)
        canvas.text(picture, middle, 14 * unit, ":", big, MUTED, 0.5)
        for k, side in ((0, -1), (1, 1)):
            canvas.text(picture, middle + side * 9 * unit, 14 * unit, f"{table['score'][k]}", big, PLAYERS[k], k == 0)
    time = f"{table['time']:.1f} s" if time_left is None else clock(time_left)
    words, colour = (time, MUTED) if note is None else (note, INK)
    canvas.text(picture, middle, (32 if has_score else 21) * unit, words, small, colour, 0.5)


def _draw_name(picture: Picture, place: Layout, name: str, role: str, player: int, room: float) -> None:
    """A player's dot, name and role, at its end of the table; the name is cut to `room` pixels."""
    unit = place.scale / SCALE
    size, small = max(round(15 * unit), 7), max(round(12 * unit), 6)
    side = 1 if player == 0 else -1
    x, _ = place.pixel(0.0 if player == 0 else place.length, 0.0)
    x, y = x - side * 8 * unit, 21 * unit
    room -= canvas.text_width(role, small) + 30 * unit
    kept = len(name)
    while kept > 1 and canvas.text_width(name, size) > room:
        kept -= 1
        name = name[:kept].rstrip() + "\u2026"
    canvas.disc(picture, x + side * 6 * unit, y, 5.5 * unit, PLAYERS[player])
    x += side * 18 * unit
    x += side * (canvas.text(picture, x, y, name, size, INK, player) + 8 * unit)
    canvas.text(picture, x, y + 1 * unit, role, small, MUTED, player)


def clock(seconds: float) -> str:
    """Time left as minutes and seconds, `2:05`."""
    whole = max(math.ceil(seconds - 1e-6), 0)
    return f"{whole // 60}:{whole % 60:02d}"
