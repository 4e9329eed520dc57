"""Every public value can be pickled, copied and compared, and comes back from another process."""

from __future__ import annotations

import copy
import inspect
import pickle
import pkgutil
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest

import irc
import irc_cpsat
import irc_pddl21

ROOT = Path(__file__).resolve().parents[2]

DSL = "task tea\nunit min\nboil 4 on stove\nbrew 3 on stove after boil\nevent late at 2:\n    "
DSL += "set duration of boil = 6\n"
ENGLISH = "Step 1. Boil the water (5 minutes)\nStep 2. Brew (4 minutes)\n"
ENGLISH += "Step 1 must precede step 2."


def tea() -> irc.Task:
    task = irc.Task("tea", time_unit="min")
    stove = task.resource("stove")
    boil = task.action("boil", 4).uses(stove)
    boil.before(task.action("brew", irc.between(3, 5)).uses(stove))
    task.action("whistle").mode("loud", 1).uses(stove)
    task.group("pot", boil).reward(3)
    task.state("hot")
    task.event(2, id="late").set_duration("boil", 6)
    return task


def late() -> irc.Task:
    """Two brews at one stove, of which one is late."""
    task = irc.Task("late", objective="minimize_tardiness")
    stove = task.resource("stove")
    task.action("boil", 4).uses(stove).due(4, weight=2)
    task.action("brew", 4).uses(stove).due(4)
    return task


def error_of(call: Any) -> irc.InputError:
    with pytest.raises(irc.InputError) as refused:
        call()
    return refused.value


def values() -> dict[str, Any]:
    """A value of every public class, by the name of its class and what is special about it."""
    task = tea()
    schedule = task.solve(time_limit=20, workers=1)
    running = irc.Execution(task, schedule)
    running.apply(irc.Event(2).set_duration("boil", 6))
    step = running.replan()
    read = irc.load(ROOT / "examples" / "burger_kitchen.json")
    rejected = irc.validate(read, irc.Schedule((irc.Entry("x", 0, 1),)))
    infeasible = irc.explain(ROOT / "examples" / "late_dinner.json", time_limit=20)
    program = task.compile("pddl21")
    batch = list(irc.batch([task, {"actons": []}], processes=1, time_limit=20, schedules=True))
    return {
        "Task": task,
        "Task, from JSON": read,
        "Task, from the DSL": irc.loads(DSL),
        "Task, from English": irc.loads(ENGLISH),
        "Task, the immutable one": read.ir,
        "Action": task["boil"],
        "Mode": irc.Action("a").mode("m", 3),
        "Resource": irc.Resource("r"),
        "StateVariable": irc.StateVariable("x", ["a", "b"], initial="a"),
        "Group": irc.Group("g", "a"),
        "Event": irc.Event(3).cancel_actions("a"),
        "Between": irc.between(1, "2 min"),
        "Schedule": schedule,
        "Schedule, looked up": (schedule, schedule["boil"])[0],
        "Entry": schedule["boil"],
        "ObjectiveValue": schedule.objective[0],
        "Status": schedule.status,
        "Program": program,
        "Program, with its files": (program, program.manifest)[0],
        "Report": irc.check(read),
        "Report, located": error_of(lambda: irc.loads('{"actons": []}')).report.located(),
        "Diagnostic": next(iter(irc.check('{"actions"'))),
        "Code": irc.Code.CYCLE,
        "Severity": irc.Severity.NOTE,
        "Verdict": irc.validate(task, schedule),
        "Verdict, at a time": irc.validate(step.task, step.schedule, 2),
        "Verdict, rejected": rejected,
        "Violation": rejected.violations[0],
        "Explanation": task.explain(time_limit=20),
        "Explanation, infeasible": infeasible,
        "Lateness": irc.explain_lateness(late(), "brew", time_limit=20),
        "BatchResult": batch[0],
        "BatchResult, of a faulty task": batch[1],
        "Execution": running,
        "ExecutionState": running.state(),
        "Step": step,
        "Simulation": task.simulate(time_limit=20),
        "SolveOptions": irc.SolveOptions(stability="5%"),
        "Outcome": error_of(lambda: irc.loads('{"actons": []}')).outcome,
        "ObjectiveLevel": irc.ObjectiveLevel("reward", 5),
        "Cancellation": irc.Cancellation(),
        "Progress": irc.Progress(
            1.0, "ortools", "makespan", (irc.ObjectiveLevel("makespan", 3, 2),)
        ),
    }


@pytest.fixture(scope="module")
def every() -> dict[str, Any]:
    return values()


def test_there_is_a_value_of_every_public_class(every: dict[str, Any]) -> None:
    classes = {
        name
        for name in irc.__all__
        if inspect.isclass(thing := getattr(irc, name)) and not issubclass(thing, BaseException)
    }
    assert {name.partition(",")[0] for name in every} == classes - {"Solving"}


def test_a_search_that_runs_says_that_it_cannot_be_pickled() -> None:
    with irc.start(tea()) as solving, pytest.raises(TypeError, match="its result can"):
        pickle.dumps(solving)
    assert pickle.loads(pickle.dumps(solving.result())) == solving.result()


def test_options_are_copied_with_what_ends_them() -> None:
    options = irc.SolveOptions(cancel=irc.Cancellation())
    copied, elsewhere = copy.deepcopy(options), pickle.loads(pickle.dumps(options))
    assert options.cancel is not None
    options.cancel.cancel()
    assert copied.budget().is_cancelled
    assert not elsewhere.budget().is_cancelled, "a copy in another process is not reached"


def test_every_value_is_pickled_copied_and_compared(every: dict[str, Any]) -> None:
    for name, value in every.items():
        for again in (
            pickle.loads(pickle.dumps(value)),
            copy.copy(value),
            copy.deepcopy(value),
        ):
            assert type(again) is type(value), name
            assert again == value, name
        assert value != object(), name


def test_what_comes_back_works_as_before(every: dict[str, Any]) -> None:
    back: dict[str, Any] = pickle.loads(pickle.dumps(every))
    assert back["Schedule"]["brew"] == every["Schedule"]["brew"]
    assert back["Program"].files == every["Program"].files
    for name in ("Task, from JSON", "Task, from the DSL", "Task, from English"):
        broken = back[name]
        broken_ir = broken.ir
        place = broken_ir.source.locate([("actions", 0, "duration")])
        assert place == every[name].ir.source.locate([("actions", 0, "duration")])
    again = back["Execution"]
    again.advance(7)
    again.observe("brew", started=7)
    assert again != every["Execution"]
    assert again.replan().schedule["brew"].start == 7


# --- exceptions ---------------------------------------------------------------------------------


def exception_classes() -> set[type[BaseException]]:
    """All classes of exceptions in our packages whose names have no underscore."""
    found: set[type[BaseException]] = set()
    for package in (irc, irc_cpsat, irc_pddl21):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if module.name.endswith(("__main__", "_worker")) or ".lsp" in module.name:
                continue
            for name, thing in vars(import_module(module.name)).items():
                if not inspect.isclass(thing) or name.startswith("_"):
                    continue
                if issubclass(thing, BaseException) and thing.__module__ == module.name:
                    found.add(thing)
    return found


def test_all_public_exceptions_have_one_base() -> None:
    found = exception_classes()
    assert len(found) > 25
    # (A signal ends a command: that is no error, and nothing may catch it on its way.)
    assert [c.__name__ for c in found if not issubclass(c, irc.IrcError)] == ["Interrupted"]


@pytest.mark.parametrize(
    "error",
    [
        error_of(lambda: irc.loads('{"actons": []}')),
        error_of(lambda: irc.loads("boil 4 onn stove")),
        irc.UnknownTarget("target", "cpsta", ["cpsat"]),
        irc.Refusal("too large", ("actions", 0), "smaller"),
        irc.AnswerError("no plan", 3),
        irc.EngineMissing("install it"),
        irc.EngineFailed("it broke"),
        irc.TimeError("no time"),
        irc.OptionError("no option"),
        irc.NameNotFound("no name"),
        irc.LibraryMissing("no library"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_an_exception_comes_back_whole(error: irc.IrcError) -> None:
    for again in (pickle.loads(pickle.dumps(error)), copy.copy(error), copy.deepcopy(error)):
        assert type(again) is type(error)
        assert str(again) == str(error)
        assert again.args == error.args
        assert vars(again) == vars(error)


# --- processes ----------------------------------------------------------------------------------

TASKS = 500


def task_number(k: int) -> dict[str, Any]:
    """A small task: some are faulty, some infeasible."""
    uses = [{"resource": "van"}]
    actions = [{"id": f"a{i}", "duration": 1 + (k + i) % 5, "uses": uses} for i in range(4)]
    document: dict[str, Any] = {"resources": [{"id": "van"}], "actions": actions}
    if k % 5 == 1:
        actions[0]["duratio"] = actions[0].pop("duration")
    if k % 5 == 2:
        document["deadline"] = 6
    if k % 5 == 3:
        document["precedence"] = [["a0", "a1"], ["a1", "a0"]]
    return document


@pytest.mark.slow
def test_500_tasks_in_other_processes_with_faulty_and_infeasible_ones() -> None:
    documents = [task_number(k) for k in range(TASKS)]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        running = [
            pool.submit(irc.solve, document, time_limit=30, workers=1) for document in documents
        ]
        outcomes = [(future.exception(), future) for future in running]
    kinds = ["solved", "shape", "infeasible", "cycle", "solved"]
    for k, (error, future) in enumerate(outcomes):
        kind = kinds[k % 5]
        if kind == "shape":
            assert isinstance(error, irc.InputError)
            assert str(error) == str(error_of(lambda k=k: irc.solve(documents[k])))
            continue
        assert error is None
        schedule = future.result()
        assert schedule.status is (
            irc.Status.OPTIMAL if kind == "solved" else irc.Status.INFEASIBLE
        )
        if kind == "solved":
            assert irc.validate(documents[k], schedule).valid
