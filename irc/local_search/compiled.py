"""Compiles the inner loops of searches when they are first called, where llvmlite is installed.

The same functions run without it, some hundred times slower. They work on arrays of whole numbers,
use only indexes and whole numbers, and draw random numbers by themselves, so that both give the
same. `IRC_COMPILED=0` in the environment makes them run without it.

All compiled functions of a module become one piece of machine code, which is kept in the user's
cache folder (`IRC_CACHE_DIR`); where that cannot be written, each process compiles anew. It is made
again when the module has changed, a constant in it, this compiler, llvmlite, or the processor.
"""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Callable, Iterator
from ctypes import CFUNCTYPE, addressof, c_int64, c_void_p
from functools import cache
from hashlib import sha256
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from itertools import pairwise
from threading import Lock, Thread
from typing import Any, TypeVar, cast

from irc.local_search.arrays import Ints as Ints
from irc.local_search.arrays import constant as constant
from irc.local_search.arrays import ints as ints
from irc.local_search.arrays import table as table
from irc.local_search.llvm.kinds import Kind, Number, Several
from irc.local_search.llvm.kinds import Row as Row
from irc.local_search.llvm.kinds import Table as Table
from irc.local_search.llvm.kinds import Tables as Tables

Function = TypeVar("Function", bound=Callable[..., Any])

LEAST_LLVMLITE = (0, 45)
"""The first version of llvmlite with the language that is written here."""


def _is_compiled() -> bool:
    if os.environ.get("IRC_COMPILED") == "0":
        return False
    try:
        found = version("llvmlite")
    except PackageNotFoundError:
        return False
    return tuple(map(int, found.split(".")[:2])) >= LEAST_LLVMLITE


IS_COMPILED: bool = _is_compiled()
"""Whether loops are compiled."""


def compiled(function: Function) -> Function:
    """The function, compiled when a function of its module is first called, if llvmlite is there.

    A public one names the kinds of its arrays: `Row`, `Table`, `Tables`. It is called with arrays
    that are whole (no columns of a table) and share no memory with each other.
    """
    return loop_of(function) if IS_COMPILED else function


def loop_of(function: Function) -> Function:
    """The function, compiled when a function of its module is first called."""
    module = _MODULES.setdefault(function.__module__, _Module(function.__module__))
    module.functions[function.__name__] = function
    return cast(Function, _Loop(module, function))


def compile_now(module: str) -> None:
    """Compiles the functions of a module, unless they are kept, before one of them is called."""
    import_module(module)
    _MODULES[module].load()


def compile_within(module: str, seconds: float | None) -> bool:
    """Whether the functions of a module are compiled within some seconds; they are later, if not.

    Without llvmlite there is nothing to compile.
    """
    import_module(module)
    own = _MODULES.get(module)
    if own is None or own.is_loaded:
        return True
    thread = Thread(target=own.load, name="irc-compilation", daemon=True)
    thread.start()
    thread.join(seconds)
    if not thread.is_alive():
        own.load()  # (It raises here what it raises there.)
    return own.is_loaded


class _Module:
    """The compiled functions of a module: one piece of machine code."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.functions: dict[str, Callable[..., Any]] = {}
        self._lock = Lock()
        self._engine: Any = None

    def address(self, name: str) -> int:
        """Where the machine code of a public function is in this process."""
        from irc.local_search.llvm.modules import entry_of

        return int(self.load().get_function_address(entry_of(name)))

    @property
    def is_loaded(self) -> bool:
        """Whether the machine code is in this process."""
        return self._engine is not None

    def load(self) -> Any:
        """The machine code in this process."""
        from irc.local_search.llvm import objects

        with self._lock:
            if self._engine is None:
                code = self._code()
                with objects.AT_WORK:
                    self._engine = objects.loaded(code)
        return self._engine

    def _code(self) -> bytes:
        """The machine code; it is kept, and half of the way to it, where a process ends before."""
        from irc.local_search.llvm import modules, objects

        file = self.file()
        if (code := objects.kept(f"{file}.o")) is not None:
            return code
        if (bitcode := objects.kept(f"{file}.bc")) is None:
            text = modules.module_text(self.name, self.functions)
            with objects.AT_WORK:
                bitcode = objects.optimised(text)
                objects.keep(f"{file}.bc", bitcode)
        with objects.AT_WORK:
            code = objects.machine_code(bitcode)
            objects.keep(f"{file}.o", code)
            objects.forget(f"{file}.bc")
        return code

    def file(self) -> str:
        """The name of the files of code, without suffix: it depends on all that the code does."""
        from irc.local_search.llvm import objects

        module = sys.modules[self.name]
        constants = sorted((k, v) for k, v in vars(module).items() if isinstance(v, int))
        known = inspect.getsource(module), constants, _compiler(), objects.machine()
        return f"{self.name.rpartition('.')[2]}-{sha256(repr(known).encode()).hexdigest()[:32]}"


_MODULES: dict[str, _Module] = {}


class _Loop:
    """A compiled function."""

    def __init__(self, module: _Module, function: Callable[..., Any]) -> None:
        self._module, self._function = module, function
        self._entry: Callable[[int], int] | None = None
        self._kinds: tuple[Kind, ...] = ()
        self._last: list[tuple[Any, list[int]]] = []
        self.__name__, self.__doc__ = function.__name__, function.__doc__

    def __call__(self, *given: Any) -> int | None:
        """The number that the function returns, or None."""
        entry = self._entry or self._loaded()
        numbers = self._numbers(given)
        room = (c_int64 * (len(numbers) or 1))(*numbers)
        result = entry(addressof(room))
        if room[0]:
            raise ZeroDivisionError(f"{self._module.name}:{room[0]}: division by zero")
        returns = self._function.__annotations__["return"]
        return None if returns in (None, "None") else result

    def _loaded(self) -> Callable[[int], int]:
        from irc.local_search.llvm.modules import kinds_of

        self._kinds = kinds_of(self._function)
        # (A call gives up the lock of the interpreter for as long as it takes.)
        entry = CFUNCTYPE(c_int64, c_void_p)(self._module.address(self.__name__))
        self._entry = entry
        return entry

    def _numbers(self, given: tuple[Any, ...]) -> list[int]:
        """The arguments as numbers. (Those of arrays are most often the last ones.)"""
        if len(given) != len(self._kinds):
            raise TypeError(f"{self.__name__} takes {len(self._kinds)} arguments")
        last, new = self._last, list[tuple[Any, list[int]]]()
        for number, (one, kind) in enumerate(zip(given, self._kinds, strict=True)):
            if isinstance(kind, Number):
                new.append((None, [int(one)]))
            elif last and one is last[number][0]:
                new.append(last[number])
            else:
                new.append((one, [*_flat(one, kind)]))
        if not last or any(a is not b for (a, _), (b, _) in zip(new, last, strict=True)):
            _refuse_shared([*_arrays(given)])
        self._last = new
        return [n for _, own in new for n in own]


def _flat(given: Any, kind: Kind) -> Iterator[int]:
    """The numbers that stand for an argument: of an array its address and its sizes."""
    if isinstance(kind, Number):
        yield int(given)
    elif isinstance(kind, Several):
        for one, own in zip(given, kind.kinds, strict=True):
            yield from _flat(one, own)
    else:
        whole = given.flags.c_contiguous and given.dtype == "int64"
        if not whole or given.ndim != kind.dimensions:
            raise TypeError(f"not a whole array of {kind.dimensions} dimensions of 64-bit numbers")
        yield from (given.ctypes.data, *given.shape)


def _arrays(given: Any) -> Iterator[Any]:
    """All arrays of some arguments."""
    if isinstance(given, tuple):
        for one in given:
            yield from _arrays(one)
    elif hasattr(given, "nbytes"):
        yield given


def _refuse_shared(arrays: list[Any]) -> None:
    """Raises `ValueError` where two arrays share memory, of which compiled code makes use."""
    spans = sorted((a.ctypes.data, a.ctypes.data + a.nbytes) for a in arrays if a.nbytes)
    if any(end > begin for (_, end), (begin, _) in pairwise(spans)):
        raise ValueError("two arrays share memory")


@cache
def _compiler() -> str:
    """The text of this compiler."""
    from irc.local_search.llvm import (
        arithmetic,
        code,
        expressions,
        kinds,
        modules,
        objects,
        statements,
    )

    parts = (arithmetic, code, expressions, kinds, modules, objects, statements)
    return "".join(map(inspect.getsource, parts))
