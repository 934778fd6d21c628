"""A request to end, by Ctrl-C or a signal, ends any command in one line."""

from __future__ import annotations

import contextlib
import signal

import puckpilot


def test_an_interrupt_while_a_command_is_loaded_ends_in_one_line(monkeypatch, capsys):
    def interrupted(name: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(puckpilot.importlib, "import_module", interrupted)
    assert puckpilot.main(["envs"]) == 130
    assert capsys.readouterr().err == "puckpilot envs: stopped\n"


def test_a_library_that_fails_of_an_interrupt_ends_in_one_line(monkeypatch, capsys):
    """numba's compiler asks in callbacks that lose the interrupt, and fails afterwards."""

    def failing(name: str) -> None:
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        raise RuntimeError("no compiled object yet")

    monkeypatch.setattr(puckpilot.importlib, "import_module", failing)
    assert puckpilot.main(["envs"]) == 143
    assert capsys.readouterr().err == "puckpilot envs: stopped\n"
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def test_what_a_callback_lost_of_an_interrupt_is_not_printed(monkeypatch, capsys):
    """The emulator's callbacks cannot raise it, and report it as ignored."""

    class Lost:
        def __del__(self) -> None:
            raise RuntimeError("ignored")

    def losing(name: str) -> None:
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        Lost()
        raise RuntimeError("stopped in between")

    monkeypatch.setattr(puckpilot.importlib, "import_module", losing)
    assert puckpilot.main(["envs"]) == 143
    assert capsys.readouterr().err == "puckpilot envs: stopped\n"
