"""What calls return: read, shown, turned into rows; and options, the same everywhere."""

from __future__ import annotations

import builtins
import sys
from dataclasses import fields
from fractions import Fraction
from inspect import signature
from types import SimpleNamespace
from typing import Any

import pytest

import irc
from irc.cli.online import replan, run, simulate
from irc.cli.solve import solve
from irc.schedule import COLUMNS
from irc.targets import EngineKeywords, SolveKeywords

HOSTILE = "<script>alert('&')</script>"


def repeated() -> irc.Schedule:
    return irc.Schedule(
        (
            irc.Entry("b", Fraction(5, 2), 4, {"van": 1}),
            irc.Entry("a", 0, 1),
            irc.Entry("a", 1, 2, {"van": 2}, mode="fast", occurrence=2, status="cancelled"),
        ),
        task="errands",
        time_unit="min",
    )


def test_entries_are_found_by_name_and_occurrence() -> None:
    schedule = repeated()
    assert (schedule["a"].end, schedule["a", 2].mode) == (1, "fast")
    assert ("a" in schedule, ("a", 2) in schedule, ("a", 3) in schedule) == (True, True, False)
    assert irc.Entry("a", 0, 1) in schedule
    assert "c" not in schedule
    assert len(schedule) == 3
    assert [(e.id, e.occurrence) for e in schedule] == [("a", 1), ("a", 2), ("b", 1)]
    assert schedule["b"].duration == Fraction(3, 2)
    assert irc.Schedule(()), "a schedule without entries is a schedule"


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("frry", "'frry' is not in the schedule; did you mean `fry`?"),
        (("fry", 2), "'fry' has no occurrence 2 in the schedule: it happens 1 time"),
        ("zzz", "'zzz' is not in the schedule; it may be optional, or of another task"),
    ],
)
def test_what_is_not_in_a_schedule_is_told(key: Any, message: str) -> None:
    schedule = irc.Schedule((irc.Entry("fry", 0, 3),))
    with pytest.raises(KeyError) as missing:
        schedule[key]
    assert (str(missing.value), isinstance(missing.value, irc.IrcError)) == (message, True)


def test_times_are_printed_with_their_unit() -> None:
    assert str(repeated()).splitlines() == [
        "errands: feasible, makespan 4 min",
        "  b  2.5 – 4 min  van",
        "  a    0 – 1 min",
        "  a    1 – 2 min  van ×2",
    ]
    assert str(irc.Schedule((), irc.Status.INFEASIBLE, task="x")) == "x: infeasible"


def test_rows_have_exact_times_in_order_of_time() -> None:
    first, _, last = repeated().to_rows()
    assert tuple(first) == COLUMNS
    assert (last["action"], last["start"], last["duration"]) == (
        "b",
        Fraction(5, 2),
        Fraction(3, 2),
    )


def test_a_data_frame_of_whichever_library_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[dict[str, list[Any]]] = []
    fake = SimpleNamespace(DataFrame=lambda columns: made.append(columns) or "frame")
    monkeypatch.setitem(sys.modules, "polars", fake)
    assert repeated().to_dataframe("polars") == "frame"
    assert list(made[0]) == list(COLUMNS)
    assert made[0]["start"] == [0.0, 1.0, 2.5]
    assert made[0]["end"] == [1, 2, 4]
    assert made[0]["resources"] == ["", "van ×2", "van"]


def test_pandas_makes_one() -> None:
    pandas = pytest.importorskip("pandas")
    frame = repeated().to_dataframe("pandas")
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame["action"]) == ["a", "a", "b"]


def test_without_a_library_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irc.display.frames.find_spec", lambda name: None)
    for name in ("pandas", "polars"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    with pytest.raises(irc.LibraryMissing, match=r"pip install pandas.*to_rows"):
        repeated().to_dataframe()
    with pytest.raises(ImportError, match="pip install polars"):
        repeated().to_dataframe("polars")
    with pytest.raises(irc.OptionError, match="pandas, polars"):
        repeated().to_dataframe("numpy")


def test_everything_shown_in_a_notebook_is_escaped() -> None:
    task = irc.Task(HOSTILE)
    van = task.resource(f"van {HOSTILE}")
    a = task.action(HOSTILE, 3).uses(van).deadline(2)
    shown = [
        task,
        irc.Schedule((irc.Entry(HOSTILE, 0, 3, {van.id: 1}, mode=HOSTILE),), task=HOSTILE),
        irc.validate(task, irc.Schedule((irc.Entry(HOSTILE, 0, 3),))),
        task.check(),
        task.explain(),
        a.deadline(9) and task.explain(),
    ]
    for thing in shown:
        html = thing._repr_html_()
        assert "<script" not in html
        assert "&lt;script&gt;" in html


def test_long_tables_end_in_a_count() -> None:
    schedule = irc.Schedule(tuple(irc.Entry(f"a{k}", k, k + 1) for k in range(1000)))
    assert "… and 800 more" in schedule._repr_html_()
    assert len(schedule._repr_html_()) < 30_000


# --- options ------------------------------------------------------------------------------------


def test_options_have_the_same_names_everywhere() -> None:
    names = {field.name for field in fields(irc.SolveOptions)}
    assert set(SolveKeywords.__annotations__) | set(EngineKeywords.__annotations__) == names
    shown = {"target", "engine", "time_limit", "memory_limit", "seed", "workers", "stability"}
    for command in (replan, simulate, run):
        assert names & set(signature(command).parameters) == shown
    only_first = {"shortcut", "deterministic", "work_limit"}
    assert names - shown == {*only_first, "on_progress", "cancel"}
    assert names & set(signature(solve).parameters) == (shown | only_first) - {"stability"}


@pytest.mark.parametrize(
    ("value", "share"),
    [
        (0, Fraction(0)),
        (0.05, Fraction(1, 20)),
        ("0.05", Fraction(1, 20)),
        ("5%", Fraction(1, 20)),
        ("150 %", Fraction(3, 2)),
        (Fraction(1, 3), Fraction(1, 3)),
        (1, Fraction(1)),
    ],
)
def test_stability_is_a_fraction(value: Any, share: Fraction) -> None:
    assert irc.SolveOptions(stability=value).share == share


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"stability": 5}, 'write 0.05 or "5%" for 5 percent'),
        ({"stability": -0.1}, "must not be negative"),
        ({"stability": "a lot"}, "expected a fraction"),
        ({"stability": float("nan")}, "expected a fraction"),
        ({"time_limit": 0}, "time_limit must be more than 0 seconds, not 0"),
        ({"time_limit": float("nan")}, "time_limit must be more than 0 seconds"),
        ({"memory_limit": 0}, "memory_limit must be at least 1"),
        ({"workers": 0}, "workers must be at least 1"),
        ({"seed": -1}, "seed must be at least 0"),
    ],
)
def test_an_option_that_cannot_be_is_refused_by_every_call(
    wrong: dict[str, Any], message: str
) -> None:
    task = irc.Task(actions=[{"id": "a", "duration": 3}])
    plan = irc.Schedule((irc.Entry("a", 0, 3),))
    for call in (
        lambda: task.solve(**wrong),
        lambda: irc.simulate(task, **wrong),
        lambda: irc.replan(task, plan, 1, **wrong),
        lambda: irc.Execution(task, plan, **wrong),
    ):
        with pytest.raises(ValueError) as refused:
            call()
        assert message in str(refused.value)
        assert isinstance(refused.value, irc.IrcError)


def test_a_misspelt_option_is_told() -> None:
    with pytest.raises(TypeError, match="did you mean `time_limit`"):
        irc.solve({"actions": []}, time_limt=3)  # type: ignore[call-arg]


def test_options_can_be_given_together() -> None:
    options = irc.SolveOptions(time_limit=5, workers=1, seed=3, shortcut=False)
    task = irc.Task()
    van = task.resource("van")
    for name in "ab":
        task.action(name, 2).uses(van)
    assert task.solve(options=options).engine == "ortools"
    assert task.solve(options=options, shortcut=True).makespan == 4
    episode = task.simulate(options=options)
    assert episode.final.makespan == 4
    assert irc.Execution(task, episode.final, options=options, stability="5%").options.share > 0


# --- the package --------------------------------------------------------------------------------


def test_compile_and_solve_have_one_default_target() -> None:
    task = irc.Task(actions=[{"id": "a", "duration": 3}])
    assert irc.compile(task).target == task.solve().target == irc.SolveOptions().target == "cpsat"


def test_every_exception_of_ours_has_one_base() -> None:
    for name in irc.__all__:
        thing = getattr(irc, name)
        if isinstance(thing, type) and issubclass(thing, BaseException):
            assert issubclass(thing, irc.IrcError), name


def test_no_public_name_hides_a_builtin_but_compile() -> None:
    assert set(irc.__all__) & set(dir(builtins)) == {"compile"}


# --- notebooks ----------------------------------------------------------------------------------


def _running() -> irc.Task:
    task = irc.Task(HOSTILE, time_unit="min")
    van = task.resource(f"van {HOSTILE}")
    task.action(HOSTILE, 3).uses(van).due(2)
    task.action("later", 2).uses(van)
    return task


def test_whatever_a_call_returns_shows_itself_in_a_notebook_without_scripts() -> None:
    task = _running()
    progress: list[irc.Progress] = []
    options = irc.SolveOptions("cpsat", shortcut=False, on_progress=progress.append)
    schedule = task.solve(options=options)
    shown: list[Any] = [task, schedule, task.explain(), irc.explain_lateness(task, HOSTILE)]
    with irc.start(task) as solving:
        assert "solved" in solving._repr_html_()
        solving.result()
    shown += [task.replan(schedule, 1), task.simulate(), solving]
    for thing in shown:
        html = thing._repr_html_()
        assert "<script" not in html, type(thing)
        assert "&lt;script&gt;" in html, type(thing)
    for thing in progress:
        assert "makespan" in thing._repr_html_()


def test_the_picture_of_a_schedule_has_a_bar_for_each_entry_and_no_reference() -> None:
    html = _running().solve()._repr_html_()
    assert html.count("<rect") == 2
    assert "<svg" in html
    assert "href" not in html
    assert " style=" not in html


def test_the_picture_of_an_explanation_marks_what_is_critical() -> None:
    task = irc.Task(time_unit="min")
    long, short, last = task.action("long", 5), task.action("short", 1), task.action("last", 2)
    long >> last
    short >> last
    assert task.explain()._repr_html_().count('stroke-width="2.5"') == 2


def test_a_long_schedule_has_a_small_picture_with_a_count() -> None:
    schedule = irc.Schedule(tuple(irc.Entry(f"a{k}", k, k + 1) for k in range(1000)))
    assert "… and 880 more in the picture" in schedule._repr_html_()
