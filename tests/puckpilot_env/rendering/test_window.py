"""The window of render_mode="human": it shows what a film of the same game does, and can be closed and left out."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from baselines.gymnasium_seat import make_seat
from puckpilot_env import match_v0
from puckpilot_env.rendering.film import Film
from puckpilot_env.rendering.window import Window

pygame = pytest.importorskip("pygame", reason="pygame is not installed; it comes with pip install '.[test]'")


@pytest.fixture(autouse=True)
def _no_screen(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """SDL's driver that draws into memory."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    yield
    pygame.display.quit()


def on_screen() -> np.ndarray:
    """What the window shows (height, width, 3)."""
    return pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)


def test_both_interfaces_show_the_game_as_it_is() -> None:
    both: Any = (
        (match_v0.parallel_env(render_mode="human"), match_v0.parallel_env(render_mode="rgb_array")),
        (make_seat("match-v0", "still", render_mode="human"), make_seat("match-v0", "still", render_mode="rgb_array")),
    )
    for shown, drawn in both:
        for env in (shown, drawn):
            env.reset(seed=3)
        space: Any = shown.action_space
        for _ in range(8):
            actions = space.low if hasattr(space, "low") else {agent: space(agent).low for agent in shown.agents}
            for env in (shown, drawn):
                env.step(actions)
        picture = drawn.render()
        assert picture is not None and shown.render() is None
        difference = np.abs(on_screen().astype(int) - picture)
        assert np.mean(difference > 8) < 0.01  # the film draws a trail behind the puck
        shown.close()
        assert pygame.display.get_surface() is None


def test_pictures_come_at_the_speed_of_the_table(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[float] = []
    monkeypatch.setattr(Window, "add", lambda window, frame: shown.append(window.fps))
    env: Any = make_seat("match-v0", "still", render_mode="human")
    env.reset(seed=1)
    for _ in range(20):  # of 0.1 s
        env.step(env.action_space.low)
    assert len(shown) == 1 + 20 * 0.1 * 50


def test_a_closed_window_stays_closed_and_the_game_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    env: Any = match_v0.parallel_env(render_mode="human")
    env.reset(seed=1)
    low = {agent: env.action_space(agent).low for agent in env.agents}
    env.step(low)
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    env.step(low)
    monkeypatch.setattr(Film, "step", lambda film, actions: pytest.fail("a film is drawn that nobody sees"))
    env.step(low)
    assert pygame.display.get_surface() is None
    env.close()


def test_of_two_environments_the_second_goes_on_when_the_first_closes_the_window() -> None:
    one, other = (match_v0.parallel_env(render_mode="human") for _ in range(2))
    low: Any = {}
    for env in (one, other):
        env.reset(seed=1)
        low = {agent: env.action_space(agent).low for agent in env.agents}  # pyright: ignore[reportAttributeAccessIssue]
        env.step(low)
    one.close()
    other.step(low)
    other.step(low)
    other.close()


def test_a_wrong_action_is_refused_before_it_is_shown() -> None:
    env = match_v0.parallel_env(render_mode="human")
    env.reset(seed=1)
    with pytest.raises(ValueError, match="action target_x of player_0 on table 0 is nan"):
        env.step({agent: np.full(4, np.nan) for agent in env.agents})
    assert pygame.display.get_surface() is None


def test_without_pygame_or_a_screen_one_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "none such")
    with pytest.raises(ValueError, match=r"needs a screen \(.*\); without one use 'rgb_array'"):
        make_seat("match-v0", render_mode="human")
    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(ValueError, match=r"needs pygame; it comes with pip install '.\[window\]'"):
        make_seat("match-v0", render_mode="human")
