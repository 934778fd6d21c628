"""The calls of Unicorn that are most of the work. Its Python binding lets other threads run during each and converts
every argument, which takes four times as long as these."""

from __future__ import annotations

import ctypes

from unicorn.unicorn_py3.unicorn import uclib

_LIBRARY = ctypes.PyDLL(uclib._name)

read_registers = _LIBRARY.uc_reg_read_batch
write_registers = _LIBRARY.uc_reg_write_batch
emu_stop = _LIBRARY.uc_emu_stop
emu_start = _LIBRARY.uc_emu_start
emu_start.argtypes = ctypes.c_void_p, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_size_t
