"""Reference plays: actions on every registered table and what followed, by which a protocol knows its game again.

A digest of source code would change with a comment, and one of a state's bits with the processor. So actions and what
players saw at some steps are kept in a file, with what each opponent of an evaluation does there; the file's digest is
part of the protocol's hash, and a version of the code plays the protocol's game if it still follows the file, within
TOLERANCE. Half of the tables of a match are shortly before its end.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baselines import make_player
from baselines.player import Seat
from puckpilot_env.files.npz_file import read_arrays
from puckpilot_env.files.whole_file import write_whole
from puckpilot_env.game.start import MATCH
from puckpilot_env.tables import Tables
from puckpilot_env.variants import all_variants

PLAYS = Path(__file__).with_name("protocol_v1.npz")
MOST_BYTES = 1 << 26
TABLES, STEPS, EVERY, SEED = 12, 60, 10, 1  # of each variant; what is seen is kept after every tenth step
PLAYERS = ("interceptor", "follower")  # of the even tables; the others are played at random
OPPONENTS = ("still", "goalie", "interceptor", "veteran", "corner_shot")  # whose decisions in seat 1 are kept
PARTS = ("actions", "decisions", "observations", "rewards", "ended")
SECONDS_LEFT, POINTS = 3.0, 6  # of half of the matches, which end in the plays: by the clock, or by the next goal
TOLERANCE = 1e-3  # in the observation's units; what processors round otherwise grows to less in six seconds

Play = Mapping[str, NDArray[np.float32]]


def record_plays(file: Path = PLAYS) -> Path:
    """Play as this version does, and write the file of a new protocol."""
    plays = {variant: _played(variant, _choose(variant)) for variant in all_variants()}
    named = {f"{_short(variant)}.{part}": array for variant, play in plays.items() for part, array in play.items()}
    return write_whole(file, lambda draft: np.savez_compressed(draft, allow_pickle=False, **named))


def digest_of_plays(file: Path = PLAYS) -> str:
    """SHA-256 of the arrays of a file, by name. ValueError, in one line, for a file that is none."""
    digest = hashlib.sha256()
    for name, array in sorted(_read(file).items()):
        digest.update(f"{name} {array.dtype.str} {array.shape}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def departures(file: Path = PLAYS) -> list[str]:
    """A line for each variant in which this version plays otherwise than the file; none where it plays the same."""
    kept = _read(file)
    found = []
    for variant in sorted({name.rsplit(".", 1)[0] for name in kept}):
        expected = {part: kept[f"{variant}.{part}"] for part in PARTS}
        if f"puckpilot/{variant}" not in all_variants():
            found.append(f"{variant} is not registered")
            continue
        played = _played(f"puckpilot/{variant}", expected["actions"])
        for part, array in expected.items():
            if played[part].shape != array.shape:
                found.append(f"{variant}: {part} have shape {played[part].shape}, in the protocol {array.shape}")
            elif not (most := float(np.abs(played[part] - array).max())) <= TOLERANCE:  # NaN is no agreement
                found.append(f"{variant}: {part} differ by up to {most:.3g} from the protocol's")
    return found


def _read(file: Path) -> dict[str, NDArray[np.float32]]:
    try:
        return read_arrays(file, MOST_BYTES)
    except Exception as error:  # a broken file breaks its readers in many ways
        raise ValueError(f"{file} has no reference plays ({type(error).__name__})") from None


def _choose(variant: str) -> NDArray[np.float32]:
    """Actions (STEPS, TABLES, 2, 4): of players at the even tables, drawn at random at the others."""
    tables, rng = _begun(variant, TABLES), np.random.default_rng(SEED)
    players = [make_player(name, Seat.from_tables(tables)) for name in PLAYERS]
    low, high = tables.action_bounds
    actions = rng.uniform(low, high, (STEPS, TABLES, 2, 4)).astype(np.float32)
    for step in range(STEPS):
        for seat, player in enumerate(players):
            actions[step, ::2, seat] = player.act(tables.observations[:, seat])[::2]
        tables.step(actions[step])
    return actions


def _played(variant: str, actions: NDArray[np.float32]) -> Play:
    """What follows of actions (steps, tables, 2, 4).

    After every EVERY-th step observations (steps / EVERY, tables, 2, d), and of each of OPPONENTS what it does then,
    decisions (steps / EVERY, opponents, tables, 4); summed over all steps, rewards (tables, 2) and the number of ended
    episodes (tables,).
    """
    tables = _begun(variant, actions.shape[1])
    opponents = [make_player(name, Seat.from_tables(tables)) for name in OPPONENTS]
    seen, decisions = [], []
    rewards, ended = np.zeros((len(tables), 2), np.float32), np.zeros(len(tables), np.float32)
    for step, chosen in enumerate(actions, 1):
        decided = [opponent.act(tables.observations[:, 1]) for opponent in opponents]
        tables.step(chosen)
        rewards += tables.rewards
        ended += tables.terminated | tables.truncated
        if step % EVERY == 0:
            seen.append(tables.observations.copy())
            decisions.append(decided)
    return {
        "actions": actions,
        "decisions": np.array(decisions, np.float32),
        "observations": np.array(seen),
        "rewards": rewards,
        "ended": ended,
    }


def _begun(variant: str, count: int) -> Tables:
    """Tables of which, in a match, every fourth is shortly before the clock runs out and every fourth before the last
    point."""
    tables = Tables(variant, count, seed=SEED)
    if tables.variant.game == MATCH:
        late = tables.variant.match_time - SECONDS_LEFT
        tables.states["time"][::4] = late
        tables.states["steps"][::4] = round(late / tables.variant.period)
        tables.states["score"][1::4] = POINTS
    return tables


def _short(variant: str) -> str:
    return variant.rsplit("/", 1)[-1]
