"""Answers a trial: what a worker process does, on this machine or in a cluster."""

from __future__ import annotations

import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irc.batches.result import bounded, ended_as
from irc.batches.trial import Pairing, TaskText, TrialOptions
from irc.errors import IrcError
from irc.outcome import FAILED
from irc.targets import Budget, Cancellation

if TYPE_CHECKING:
    from irc.model import Task


def answered(
    request: Mapping[str, Any], schedules: bool = False, cancel: Cancellation | None = None
) -> dict[str, Any]:
    """The answer to a request of `Trial.request`: plain values, whatever happens.

    With `schedules` it has the schedule. A faulty task, a refusal, a missing engine and a breakdown
    are answers too; of a breakdown that irc does not know, with the place in the code.
    """
    options = TrialOptions(**request["options"])
    budget = Budget(options.time_limit, cancel=cancel)
    try:
        return _solved(request, options, budget, schedules)
    except IrcError as error:
        return {"outcome": bounded(error.outcome), "seconds": round(budget.elapsed, 3)}
    except MemoryError:
        return ended_as(FAILED, "there was not enough memory", budget.elapsed)
    except Exception as error:  # noqa: BLE001 - it becomes the result of this trial
        where = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(where.filename).name}:{where.lineno}"
        text = f"{type(error).__name__} at {place}: {error}"
        return ended_as(FAILED, f"irc itself broke down: {text}", budget.elapsed)


def _solved(
    request: Mapping[str, Any], options: TrialOptions, budget: Budget, schedules: bool
) -> dict[str, Any]:
    from irc.driver.solve import solve_task

    task = _task(request["source"])
    pair = Pairing(*request["pair"])
    schedule = solve_task(task, options.solving(pair, budget.cancel), budget).schedule
    document = schedule.to_dict()
    return {
        "outcome": bounded(schedule.outcome),
        "solver": schedule.engine,
        "objective": document["objective"] if schedule.answered else [],
        "seconds": round(budget.elapsed, 3),
        **({"schedule": document} if schedules and schedule.answered else {}),
    }


def _task(source: Mapping[str, Any]) -> Task:
    """The task of a request's text. Raises `InputError`."""
    from irc.frontends.files import parse_task
    from irc.frontends.formats import PLANNER, SCHEDULE_SPEC

    sent = TaskText(**source)
    if sent.problem is not None:
        from irc.frontends.importers.pddl import read_pddl

        text, name = sent.problem
        return read_pddl((sent.text, sent.name), (text, name))[0]
    if sent.format == PLANNER:
        from irc.frontends.importers.planner import import_planner

        return import_planner(sent.text, sent.name)
    if sent.format == SCHEDULE_SPEC:
        from irc.frontends.importers.schedule_spec import import_schedule_spec

        return import_schedule_spec(sent.text, sent.name, {}, None)
    return parse_task(sent.text, sent.name).task
