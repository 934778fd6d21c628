"""The one way in which this project compiles: `@kernel`.

numba's own cache notices edits of the decorated file but not of the functions that it calls in other files, so the
cache folder is keyed here by a hash of every kernel source: an edit anywhere starts a fresh folder. Packages above the
players have one each, so that an edit there leaves the simulator compiled. Wherever the same sources lie, in another
clone or environment, they use the same folder.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numba
from numba import types
from numba.core import caching as numba_caching
from numba.core.ccallback import CFunc
from numba.extending import intrinsic

_ROOT = Path(__file__).parent
_KEEP_DAYS = 30


def _simulator_sources() -> list[Path]:
    """Every file that defines kernels of the simulator and its players, or what they are compiled against."""
    sources = [
        path for folder in ("physics", "game", "batch", "residual") for path in sorted((_ROOT / folder).rglob("*.py"))
    ]
    sources += [_ROOT / f"{name}.py" for name in ("effect", "kernel", "parameters")]
    return sources + _package_sources("baselines")


def _package_sources(package: str) -> list[Path]:
    files = sorted((_ROOT.parent / package).rglob("*.py"))
    return [path for path in files if path.parent.name != "commands"]


def _hash_of(sources: list[Path]) -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sources:
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _make_cache_folder(sources: list[Path]) -> Path:
    """The folder for this version of the sources; a temporary one where the home folder cannot be written."""
    try:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "puckpilot"
        folder = base / _hash_of(sources)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "used").touch()
    except (OSError, RuntimeError):  # Path.home() raises the latter for a user whom the system does not know
        return Path(tempfile.mkdtemp(prefix="puckpilot-kernels-"))
    oldest = time.time() - _KEEP_DAYS * 86400
    for other in base.iterdir():
        used = other / "used"
        if other != folder and used.exists() and used.stat().st_mtime < oldest:
            shutil.rmtree(other, ignore_errors=True)
    return folder


CACHE_FOLDER = _make_cache_folder(_simulator_sources())  # of the simulator and its players


@functools.cache
def cache_folder_of(package: str) -> Path:
    """Where the kernels of a package are kept."""
    if package in (_ROOT.name, "baselines"):
        return CACHE_FOLDER
    return _make_cache_folder(_simulator_sources() + _package_sources(package))


# Counting references to arrays costs a tenth of a step, and more where two threads count in the same place.
_FLAGS: Any = {"nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}


def _mend_damaged(cache: Any) -> None:
    """Let a numba cache whose files are cut short or empty, as a full disk leaves them, begin anew."""
    load = cache.load_overload

    def load_overload(signature: Any, context: Any) -> Any:
        try:
            return load(signature, context)
        except Exception:  # a cut pickle breaks in many ways
            cache.flush()
            return None

    cache.load_overload = load_overload


_caching: Any = numba_caching  # what is asked of it has no public name


class _ByModule(_caching._SourceFileBackedLocatorMixin, _caching._CacheLocator):
    """Where numba keeps a compiled function: in its package's folder, by its module's name and not its file's path."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._py_file, self._lineno = file, function.__code__.co_firstlineno  # which the mixin reads
        self._path = cache_folder_of(function.__module__.partition(".")[0]) / function.__module__

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._path)


@contextlib.contextmanager
def _kept_by_module() -> Iterator[None]:
    """Within, numba keeps what it compiles where `_ByModule` says."""
    cache = _caching.FunctionCache._impl_class
    before, cache._locator_classes = cache._locator_classes, [_ByModule]
    try:
        yield
    finally:
        cache._locator_classes = before


def _compiled(function: Callable[..., Any], **flags: Any) -> Callable[..., Any]:
    with _kept_by_module():
        made: Any = numba.njit(cache=True, **{**_FLAGS, **flags})(function)
        _mend_damaged(made._cache)
        return made


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile `function` with numba on its first call: no GIL, IEEE divisions, cached in its package's folder.

    It counts no references to arrays, so it can neither make arrays nor assign a whole one to a slice of another.
    """
    return _compiled(function)


def inlined_kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """`kernel` for a function that becomes a part of every kernel that calls it, and is not compiled by itself there.

    For small functions that are called often, and for large ones that are called at one place: each kernel is compiled
    together with all that it calls, so that every large one on the way up is compiled once more.
    """
    return _compiled(function, inline="always")


def array_kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """`kernel` for a function that makes arrays, or assigns whole ones.

    It may not make arrays of records: numba frees an array after its last use by name, while a record taken out of it
    is still read. They come from the caller, who holds them.
    """
    return _compiled(function, _nrt=True)


def calling_kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """`kernel` for a function that calls Python often: it keeps the GIL, which it would wait for at every call."""
    return _compiled(function, nogil=False)


def inner(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that was made inside another one: it becomes part of each `kernel` that calls it.

    It has no cache of its own, for numba tells functions apart by where they stand; its callers' caches hold it. There
    each gets a name of its own, by what it calls: two of one name, in kernels that were compiled in two processes,
    would be taken for one and the same when both kernels are loaded.
    """
    calls = [cell.cell_contents.py_func for cell in function.__closure__ or ()]
    words = " ".join(f"{one.__module__}.{one.__qualname__}" for one in calls)
    function.__qualname__ += f"_{hashlib.sha256(words.encode()).hexdigest()[:16]}"
    return numba.njit(**_FLAGS)(function)


def c_callback(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function at once for a library in C to call; `signature` is numba's, `address` is where it is."""

    def compiled(function: Callable[..., Any]) -> Any:
        with _kept_by_module():
            flags = {"error_model": _FLAGS["error_model"]}
            made: Any = CFunc(function, (signature.args, signature.return_type), {}, flags)
            made.enable_caching()
            _mend_damaged(made._cache)
            made.compile()
            return made

    return compiled


def _pointer_to(_typing: Any, _address: Any) -> Any:
    """An address (int64) as a pointer."""

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(types.voidptr))

    return types.voidptr(types.int64), generate


_carray: Any = numba.carray  # pyright: ignore[reportPrivateImportUsage]
_as_pointer: Any = intrinsic(_pointer_to)


@array_kernel
def array_at(address, shape, dtype):
    """The array whose data are at an address (int64), which kernels take faster from Python than an array."""
    return _carray(_as_pointer(address), shape, dtype)


_announced: set[str] = set()


def announce_compilation(marker: str, what: str = "the simulator", package: str = _ROOT.name) -> None:
    """Say on stderr that `what` will be compiled, once a process, if the kernel named `marker` of a package was not."""
    if what not in _announced and not any(cache_folder_of(package).rglob(f"*{marker}*.nbi")):
        print(f"puckpilot: compiling {what} (once after each change, a minute or two) ...", file=sys.stderr)
        _announced.add(what)
