"""Calls between compiled code, Unicorn and Python: Unicorn's functions as kernels call them, and the functions in
Python that kernels call, by their addresses."""

from __future__ import annotations

import ctypes
from typing import Any

from llvmlite import binding, ir
from numba import types
from numba.extending import intrinsic
from unicorn.unicorn_py3.unicorn import uclib

ANGLE = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)  # of a shaft [rad] at a time [us]
DRIVE = ctypes.CFUNCTYPE(None, ctypes.c_double, ctypes.c_double, ctypes.c_double)  # time [us], duties of both motors

# of Unicorn's callbacks; the last argument is the address that was given with them
READ_SIGNATURE = types.uint64(types.voidptr, types.uint64, types.uint32, types.int64)
WRITE_SIGNATURE = types.void(types.voidptr, types.uint64, types.uint32, types.uint64, types.int64)
CODE_SIGNATURE = types.void(types.voidptr, types.uint64, types.uint32, types.int64)
INTERRUPT_SIGNATURE = types.void(types.voidptr, types.uint32, types.int64)


def address_of(function: Any) -> int:
    """Where a function of ctypes is."""
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert address is not None
    return address


def _unicorn(name: str, returns: Any, *arguments: Any) -> Any:
    binding.add_symbol(name, address_of(getattr(uclib, name)))
    return types.ExternalFunction(name, returns(*arguments))


# handles and addresses are integers here
emu_start = _unicorn("uc_emu_start", types.int32, types.int64, types.uint64, types.uint64, types.uint64, types.uint64)
emu_stop = _unicorn("uc_emu_stop", types.int32, types.int64)
read_register = _unicorn("uc_reg_read", types.int32, types.int64, types.int32, types.int64)
read_registers = _unicorn("uc_reg_read_batch", types.int32, types.int64, types.int64, types.int64, types.int32)
write_registers = _unicorn("uc_reg_write_batch", types.int32, types.int64, types.int64, types.int64, types.int32)


def _call_angle(_typing: Any, _function: Any, _now: Any) -> Any:
    """Call a function of type ANGLE at an address (int64), with a time [us]."""

    def generate(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(ir.DoubleType(), [ir.DoubleType()])
        return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), [arguments[1]])

    return types.float64(types.int64, types.float64), generate


def _call_drive(_typing: Any, _function: Any, _now: Any, _first: Any, _second: Any) -> Any:
    """Call a function of type DRIVE at an address (int64), with a time [us] and two duties."""

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(ir.VoidType(), [ir.DoubleType()] * 3)
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), arguments[1:])
        return context.get_dummy_value()

    return types.void(types.int64, types.float64, types.float64, types.float64), generate


call_angle: Any = intrinsic(_call_angle)
call_drive: Any = intrinsic(_call_drive)
