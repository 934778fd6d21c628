"""A window that shows a game as it is played, at the table's own speed: what `render_mode="human"` opens.

It needs pygame: `pip install '.[window]'`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.rendering.film import Film
from puckpilot_env.tables import Tables

FPS = 50.0


class Window:
    """Takes pictures and shows each when it is due. Once its user has closed it nothing is shown, nor waited for."""

    fps = FPS

    def __init__(self, title: str) -> None:
        """ValueError, in one line, where pygame is not installed or there is no screen."""
        try:
            import pygame
        except ModuleNotFoundError:
            raise ValueError("render_mode='human' needs pygame; it comes with pip install '.[window]'") from None
        self._pygame: Any = pygame
        self._title, self._screen, self.closed = title, None, False
        try:
            pygame.display.init()
        except pygame.error as error:
            raise ValueError(f"render_mode='human' needs a screen ({error}); without one use 'rgb_array'") from None
        self._clock = pygame.time.Clock()

    def add(self, frame: NDArray[np.uint8], /) -> None:
        """Show a picture (height, width, 3), RGB, a 50th of a second after the one before."""
        if self.closed:
            return
        pygame, size = self._pygame, (frame.shape[1], frame.shape[0])
        if self._screen is None:
            self._screen = pygame.display.set_mode(size)
            pygame.display.set_caption(self._title)
        try:
            self._screen.blit(pygame.image.frombuffer(np.ascontiguousarray(frame).tobytes(), size, "RGB"), (0, 0))
            pygame.display.flip()
        except pygame.error:  # pygame has one window alone, which another environment closed
            self.closed = True
            return
        self._clock.tick(self.fps)
        if any(event.type == pygame.QUIT for event in pygame.event.get()):
            self.close()

    def close(self) -> None:
        """Close the window."""
        if not self.closed:
            self.closed = True
            self._pygame.display.quit()


class ShownGame:
    """A film of the first table in a window of its own, until that is closed. ValueError as of `Window`."""

    def __init__(self, tables: Tables, names: Sequence[str]) -> None:
        self._window = Window(tables.variant.id)
        self._film = Film(tables, self._window, names=names)

    def step(self, actions: NDArray[np.float32]) -> None:
        """Show the step that `tables.step(actions)` is about to play."""
        if not self._window.closed:
            self._film.step(actions)

    def close(self) -> None:
        """Close the window."""
        self._window.close()
