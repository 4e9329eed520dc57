"""Compiled functions do what they do in plain Python, or are refused with their place."""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable
from pathlib import Path
from threading import Event
from types import ModuleType
from typing import Any

import pytest

from builders import after_passes
from irc.local_search import compiled
from irc.local_search.llvm import modules, objects
from irc.local_search.llvm.kinds import NotCompiled
from irc.local_search.search import search_of
from irc.local_search.ways import NotInTime
from local_search import loop_examples
from local_search_tasks import job_shop

pytest.importorskip("llvmlite")

NUMBERS = (-9, -5, -2, 1, 2, 3, 7, 8)
SEARCHES = ("tabu", "active_lists", "genetic", "lists")


SMALL = """
from irc.local_search.compiled import Row

STEP = 3

def add(row: Row) -> int:
    row[0] += STEP
    return row[0]
"""


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for machine code that many tests use."""
    return tmp_path_factory.mktemp("kept")


@pytest.fixture(autouse=True)
def _in_shared_folder(shared: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(objects.FOLDER, str(shared))
    monkeypatch.setattr(compiled, "_MODULES", {})


def functions(module: ModuleType) -> dict[str, Callable[..., Any]]:
    """The functions of a module, without those that it imports."""
    own = {k: f for k, f in vars(module).items() if inspect.isfunction(f)}
    return {name: f for name, f in own.items() if f.__module__ == module.__name__}


def loops(module: ModuleType) -> dict[str, Callable[..., Any]]:
    """The functions of a module, compiled when the first of them is called."""
    return {name: compiled.loop_of(f) for name, f in functions(module).items()}


def arrays(given: Any) -> Any:
    """Lists of numbers, also those in tuples, as arrays."""
    import numpy

    if isinstance(given, tuple):
        return tuple(map(arrays, given))
    return numpy.array(given, "int64") if isinstance(given, list) else given


def check(name: str, *cases: tuple[Any, ...]) -> None:
    """Compiled and plain, a function returns the same and leaves the same in arrays."""
    loop, plain = loops(loop_examples)[name], getattr(loop_examples, name)
    for case in cases:
        given, again = arrays(case), arrays(case)
        assert loop(*given) == plain(*again), case
        assert repr(given) == repr(again), case


def test_arithmetic_is_that_of_python() -> None:
    check("arithmetic", *((a, b, [0] * 14) for a in (*NUMBERS, 0, 1 << 40) for b in NUMBERS))


def test_truths_and_choices() -> None:
    cases = ((a, b, on) for a in (-3, 0, 2, 5) for b in (-1, 0, 2, 6) for on in (True, False))
    check("truths", *cases)


def test_loops() -> None:
    check("loops", *((a, b, [0] * 12) for a in (-5, 0, 4, 9) for b in (-40, -3, 0, 4)))


def test_rows_tuples_and_sizes() -> None:
    table, cube = [[1, 2, 3], [4, 5, 6]], [[[1, 2, 3], [4, 5, 6]]] * 2
    check("arrays", (table, cube, ([7, 8], [9]), [3, 1, 2]), ([[5]], cube, ([1], [2, 3]), [4]))


def test_what_returns_nothing() -> None:
    check("set_all", ([1, 2, 3], 7), ([1], -1), ([], 2))


def test_a_division_by_0_is_an_error_with_its_line() -> None:
    (out,) = arrays(([0] * 14,))
    arithmetic = loops(loop_examples)["arithmetic"]
    with pytest.raises(ZeroDivisionError, match=r"local_search\.loop_examples:\d+: division"):
        arithmetic(3, 0, out)
    assert isinstance(arithmetic(3, 1, out), int)


def test_arguments_of_another_kind_are_refused() -> None:
    (table, row) = arrays(([[1, 2], [3, 4]], [1, 2]))
    set_all, store = (loops(loop_examples)[name] for name in ("set_all", "loops"))
    for wrong in (table, table[:, 0], row.astype("int32")):
        with pytest.raises(TypeError, match="not a whole array of 1 dimension"):
            set_all(wrong, 1)
    with pytest.raises(TypeError, match="takes 3 arguments"):
        store(1, 2)


def test_arrays_that_share_memory_are_refused() -> None:
    (table, cube, more) = arrays(([[1, 2], [3, 4]], [[[1, 2, 3], [4, 5, 6]]], [1]))
    with pytest.raises(ValueError, match="share memory"):
        loops(loop_examples)["arrays"](table, cube, (more, table[1]), more.copy())


WRONG = {
    "return 2.5": "2.5 is no whole number",
    "return a / 2": "no Div can be compiled",
    "return a and 2": "`and` and `or` of numbers",
    "return unknown": "'unknown' has no value here",
    "return unknown(a)": "'unknown' is no compiled function",
    "return row[a, a]": "only arrays have entries, with at most as many indexes",
    "return row": "the value has another kind",
    "return [a]": "no List can be compiled",
    "return a if a else row": "both values must be of one kind",
    "a = row": "'a' is of another kind",
    "a, b = a": "a tuple of 2 is needed here",
    "with a:\n  pass": "no With can be compiled",
    "for k in row:\n  pass": "loops are over ranges",
    "for k in range(0, 9, a):\n  pass": "the step of a range is a constant",
    "while a:\n  a -= 1\n else:\n  pass": "no `else` of a loop",
    "return _both(row, row)": "an array is given twice",
}


@pytest.mark.parametrize(("body", "reason"), WRONG.items())
def test_what_cannot_be_compiled_is_refused_with_its_place(
    body: str, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = module_of(
        "from irc.local_search.compiled import Row\n"
        f"def wrong(a: int, row: Row) -> int:\n {body}\n"
        "def _both(row: Row, other: Row) -> int:\n return row[0] + other[0]\n",
        tmp_path,
        monkeypatch,
    )
    with pytest.raises(NotCompiled) as error:
        modules.module_text("written", functions(module))
    assert f"written:3: {reason}" in str(error.value)


def module_of(text: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A module with a text."""
    (folder / "written.py").write_text(text)
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.delitem(sys.modules, "written", raising=False)
    return importlib.import_module("written")


def test_public_functions_name_the_kinds_of_their_arrays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "from irc.local_search.compiled import Ints\ndef f(a: Ints) -> int:\n return a[0]\n"
    module = module_of(text, tmp_path, monkeypatch)
    with pytest.raises(NotCompiled, match="f: annotate arrays"):
        modules.module_text("written", functions(module))


@pytest.mark.parametrize("name", SEARCHES)
def test_all_searches_can_be_compiled(name: str) -> None:
    from llvmlite import binding

    # (Without optimisation, which takes most of the time.)
    module = importlib.import_module(f"irc.local_search.{name}")
    binding.parse_assembly(modules.module_text(module.__name__, functions(module))).verify()


# --- what is kept ---------------------------------------------------------------------------------


class Kept:
    """A small module whose machine code is kept in a folder of its own."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.folder, self.made, self._patch = folder / "kept", 0, monkeypatch
        self.module = module_of(SMALL, folder, monkeypatch)
        self._optimised = objects.optimised
        monkeypatch.setenv(objects.FOLDER, str(self.folder))
        monkeypatch.setattr(objects, "optimised", self._noted)

    def _noted(self, text: str) -> bytes:
        self.made += 1
        return self._optimised(text)

    def run(self) -> None:
        """Calls a loop as a new process does."""
        self._patch.setattr(compiled, "_MODULES", {})
        (row,) = arrays(([4],))
        assert loops(self.module)["add"](row) == row[0] == 4 + self.module.STEP


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Kept:
    """A small module whose machine code is kept in a folder of its own."""
    return Kept(tmp_path, monkeypatch)


def test_machine_code_is_kept(kept: Kept) -> None:
    kept.run()
    kept.run()
    assert kept.made == 1
    (file,) = kept.folder.iterdir()
    file.write_bytes(file.read_bytes()[:-1])
    kept.run()
    assert kept.made == 2  # The file was damaged.


def test_a_process_goes_on_where_another_one_was_ended(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    machine_code = objects.machine_code
    monkeypatch.setattr(objects, "machine_code", lambda _: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        kept.run()
    monkeypatch.setattr(objects, "machine_code", machine_code)
    kept.run()
    assert kept.made == len([*kept.folder.iterdir()]) == 1


def test_a_module_can_be_compiled_before_it_is_needed(kept: Kept) -> None:
    loops(kept.module)
    compiled.compile_now("written")
    kept.run()
    assert kept.made == 1


def test_compilation_takes_no_longer_than_it_may(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    loops(kept.module)
    goes_on, machine_code = Event(), objects.machine_code

    def waiting(bitcode: bytes) -> bytes:
        goes_on.wait()
        return machine_code(bitcode)

    monkeypatch.setattr(objects, "machine_code", waiting)
    assert not compiled.compile_within("written", 0.01)
    goes_on.set()
    assert compiled.compile_within("written", 60)
    kept.run()
    assert kept.made == 1


def test_a_search_that_is_not_compiled_in_time_does_not_apply(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compiled, "compile_within", lambda module, seconds: seconds > 1)
    problem = after_passes(job_shop(1))
    with pytest.raises(NotInTime):
        search_of(problem, seconds=0.5)
    assert search_of(problem, seconds=2.0).value is None
    assert search_of(problem).value is None


def test_another_constant_or_machine_is_compiled_anew(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept.run()
    monkeypatch.setattr(kept.module, "STEP", 4)
    kept.run()
    monkeypatch.setattr(objects, "machine", lambda: "another one")
    kept.run()
    assert kept.made == len([*kept.folder.iterdir()]) == 3


def test_where_no_folder_can_be_written_loops_are_compiled_all_the_same(kept: Kept) -> None:
    kept.folder.write_text("a file")
    kept.run()
    kept.run()
    assert kept.made == 2


@pytest.mark.parametrize(("found", "is_compiled"), [("0.44.0", False), ("0.45.1rc1", True)])
def test_an_old_llvmlite_is_not_used(
    found: str, is_compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("IRC_COMPILED", raising=False)
    monkeypatch.setattr(compiled, "version", lambda name: found)
    assert compiled._is_compiled() is is_compiled
    monkeypatch.setenv("IRC_COMPILED", "0")
    assert not compiled._is_compiled()
