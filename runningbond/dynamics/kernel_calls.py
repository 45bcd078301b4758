"""The kernels of a time step, called by address.

A function that is called by name is compiled into its caller again, so the loop over steps would take seconds to
compile for each set of kernels that a model chooses. The loop therefore takes addresses as arguments, and depends only
on the types of the arrays.
"""

from typing import Any, TypeAlias

import numpy as np
from numba import boolean, float64, int64, typeof, types, uint64
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic

from .system import Interface, Kernel

Addresses: TypeAlias = tuple[int, int, int, int, int]
"""Addresses of gather, reframe, law, scatter and update; valid only in the present process."""

VALUES, ROWS = float64[::1], float64[:, ::1]
PARAMETERS = types.Tuple((uint64[::1], ROWS))
FRAMES = types.Tuple((boolean[::1], int64))
MODES = types.UniTuple(VALUES, 3)
STATE = types.Tuple((VALUES, VALUES, ROWS, VALUES, VALUES))

GATHER = (VALUES, None, VALUES, VALUES)
REFRAME = (None, FRAMES, ROWS)
LAW = (VALUES, VALUES, PARAMETERS, ROWS, float64, VALUES, VALUES)
SCATTER = (VALUES, VALUES, None, VALUES)
UPDATE = (MODES, None, STATE, float64, float64)
"""Argument types of each kernel; None stands for a type of the model: its geometry, or the memory of its update."""

_FOUND: dict[Any, Addresses] = {}


def addresses(interface: Interface, advance: Kernel, memory: tuple[Any, ...]) -> Addresses:
    """Addresses of an interface's kernels and of an update with its memory."""
    kernels = interface.gather, interface.reframe, interface.law.kernel, interface.scatter, advance
    geometry = tuple(interface.geometry)
    # Determining Numba types takes longer than some hundred steps, and contacts are searched for about as often.
    known_by = kernels, _kinds(geometry), _kinds(memory)
    if known_by not in _FOUND:
        _FOUND[known_by] = _compiled(kernels, typeof(geometry), typeof(memory))
    return _FOUND[known_by]


def _compiled(kernels: tuple[Any, ...], geometry: Any, memory: Any) -> Addresses:
    """Addresses of kernels, compiled for given types of geometry and memory."""
    own = geometry, geometry, None, geometry, memory
    found = []
    for kernel, arguments, its in zip(kernels, (GATHER, REFRAME, LAW, SCATTER, UPDATE), own, strict=True):
        compiled = kernel.get_compile_result(types.void(*(each or its for each in arguments)))
        found.append(int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name)))
    gather, reframe, law, scatter, advance = found
    return gather, reframe, law, scatter, advance


def _kinds(value: Any) -> Any:
    """What the type of a value depends on: a key that is cheap to compute."""
    if isinstance(value, tuple):
        return type(value), *map(_kinds, value)
    if isinstance(value, np.ndarray):
        return value.dtype, value.ndim, value.flags.c_contiguous, value.flags.writeable
    return type(value)


def _call(arguments: tuple[Any, ...]) -> Any:
    """Make a function that calls, from a kernel, another kernel at an address, and propagates its exceptions.

    Arguments of other types than the kernel was compiled for are converted, or refused.
    """

    @intrinsic  # type: ignore[untyped-decorator]
    def call(typing: Any, address: Any, *given: Any) -> tuple[Any, Any]:
        taken = types.void(*(each or its for each, its in zip(arguments, given, strict=True)))
        for each, its in zip(taken.args, given, strict=True):
            if typing.can_convert(its, each) is None:
                raise TypingError(f"a kernel takes {each}, and no {its}")

        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            convention = context.call_conv
            place = builder.inttoptr(values[0], convention.get_function_type(types.void, taken.args).as_pointer())
            unpacked = cgutils.unpack_tuple(builder, values[1])
            status, _ = convention.call_function(builder, place, types.void, taken.args, unpacked)
            with cgutils.if_unlikely(builder, status.is_error):
                convention.return_status_propagate(builder, status)
            return context.get_dummy_value()

        return types.void(address, types.StarArgTuple(taken.args)), generate

    return call


gather, reframe, respond, scatter, advance = map(_call, (GATHER, REFRAME, LAW, SCATTER, UPDATE))
