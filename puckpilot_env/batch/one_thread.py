"""A batch is played by one thread at a time: another one that comes in meanwhile is refused, and no step is lost."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from threading import RLock
from typing import Any, TypeVar

Method = TypeVar("Method", bound=Callable[..., Any])


class Inside:
    """Which thread is inside, if any. A copy begins with nobody inside."""

    def __init__(self) -> None:
        lock = RLock()
        self.enter, self.leave = lock.acquire, lock.release

    def __reduce__(self) -> tuple[Any, ...]:
        return Inside, ()


def one_thread(method: Method) -> Method:
    """A method that raises RuntimeError, having changed nothing, while another thread is in one of the same `inside`.

    Its object has an `inside`, which it may share with others. The thread that is inside may come in once more: from
    one of these objects to another, and after a ctrl-C wherever that came.
    """
    words = f"{method.__name__}() by two threads at once on the same tables; expected one thread at a time: "

    @wraps(method)
    def guarded(self: Any, *args: Any, **kwargs: Any) -> Any:
        if not self.inside.enter(False):
            raise RuntimeError(f"{words}give each its own tables, or let them take turns")
        try:
            return method(self, *args, **kwargs)
        finally:
            self.inside.leave()

    return guarded  # pyright: ignore[reportReturnType] - it takes and returns what the method does
