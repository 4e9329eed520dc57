"""A strict judge of Online Robo Challenge episodes, from the raw episode and the steps alone.

A history is approved where, at every step, the schedule keeps all that was known then (work,
durations, order of processing, stations, robots, stack order, lags, deadlines, stock), has left
what ran as it was, plans nothing before the event, and in the end is worth what an exact
continuation from the choices committed by then is worth: half-done candidate goals finished first,
then reward, then makespan.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from oracles.online_robo_best import Best, UndecidedError, continuation
from oracles.online_robo_kitchen import (
    Document,
    Known,
    Plan,
    Run,
    Worth,
    half_done_goals,
    initial,
    moments_of,
    reveal,
    time_of,
)

__all__ = ["UndecidedError", "Verdict", "judge"]


@dataclass(frozen=True)
class Verdict:
    """`faults` is empty where the history is valid at every step.

    `worse` has the steps (by number) that are worth less than an exact continuation, and what is
    possible. `optima` has for each step the best (reward, makespan) from what was committed by
    then (the reward is None where there are no candidate goals), and None where nothing can follow.
    """

    faults: tuple[str, ...]
    worse: Mapping[int, str]
    optima: tuple[Worth | None, ...]

    @property
    def approved(self) -> bool:
        """Whether the history is valid, and its last step worth what an exact one is."""
        return not self.faults and len(self.optima) - 1 not in self.worse


def judge(episode: Document, simulation: Document, *, seconds: float = 60) -> Verdict:
    """The verdict on what `simulate` printed for an episode.

    Raises `ValueError` for an episode that says what this judge does not know, and
    `UndecidedError` where a continuation takes longer than `seconds`.
    """
    known = initial(episode["initial_task"])
    moments = moments_of(episode["events"])
    steps = simulation["steps"]
    faults: list[str] = []
    worse: dict[int, str] = {}
    optima: list[Worth | None] = []
    expected = [Fraction(0), *(at for at, _ in moments)]
    told = [time_of(step["at"]) for step in steps]
    if told != expected:
        return Verdict((f"steps at {_shown(told)}, not at {_shown(expected)}",), {}, ())
    committed: Plan = {}
    for k, step in enumerate(steps):
        at = expected[k]
        if k:
            for event in moments[k - 1][1]:
                reveal(known, event["delta"])
        before = committed
        frozen = {name: run for name, run in before.items() if run.start < at}
        best = continuation(known, frozen, at, seconds)
        optima.append(best and best.worth)
        faults += [f"step {k}: {said}" for said in _step_faults(known, step, before, at, best)]
        if best is not None and (less := _less(known, step, best)):
            worse[k] = less
        names = [None] if not k else [event.get("id") for event in moments[k - 1][1]]
        if _event_names(step) != names:
            faults.append(f"step {k}: says that its events are {step['event']}, not {names}")
        committed, repeated = _plan(step["schedule"])
        faults += [f"step {k}: {name} is there more than once" for name in repeated]
    if steps and _plan(simulation["final"]) != (committed, []):
        faults.append("the final schedule is not that of the last step")
    return Verdict(tuple(faults), worse, tuple(optima))


def _event_names(step: Document) -> list[Any]:
    told = step["event"]
    if isinstance(told, list):
        return told or [None]
    return [told]


# --- one step -------------------------------------------------------------------------------------


def _plan(schedule: Document) -> tuple[Plan, list[str]]:
    """The entries by action, and the actions that are there more than once."""
    plan: Plan = {}
    repeated = []
    for entry in schedule["actions"]:
        if entry["id"] in plan or entry.get("occurrence", 1) != 1:
            repeated.append(entry["id"])
        plan[entry["id"]] = Run(
            time_of(entry["start"]),
            time_of(entry["end"]),
            entry.get("resources", {}),
            entry.get("status"),
        )
    return plan, repeated


def _step_faults(
    known: Known, step: Document, before: Plan, at: Fraction, best: Best | None
) -> Iterator[str]:
    schedule = step["schedule"]
    if schedule["status"] == "infeasible":
        if best is not None:
            yield f"called infeasible, and there is a continuation ({best.worth})"
        return
    if schedule["status"] not in ("optimal", "feasible"):
        yield f"there is no answer ({schedule['status']})"
        return
    plan, _ = _plan(schedule)
    frozen = {name: run for name, run in before.items() if run.start < at}
    yield from _snapshot(step, before, plan, at)
    yield from _history(frozen, plan, at)
    yield from _presence(known, plan)
    yield from _own_times(known, frozen, plan)
    yield from _orders(known, plan)
    yield from _capacities(known, plan)
    yield from _stock(known, plan)
    yield from _value(known, step, frozen, plan, best)


def _snapshot(step: Document, before: Plan, plan: Plan, at: Fraction) -> Iterator[str]:
    """What the step says of the old schedule: what had ended, what ran, and what has moved."""
    parts = {
        "completed": {n for n, r in before.items() if r.start < at and r.end <= at},
        "running": {n for n, r in before.items() if r.start < at < r.end},
    }
    for key, names in parts.items():
        if sorted(step[key]) != sorted(names):
            yield f"{key} are {sorted(names)}, and it says {sorted(step[key])}"
    moved = sum(
        name not in plan or (plan[name].start, plan[name].resources) != (run.start, run.resources)
        for name, run in before.items()
        if run.start >= at
    )
    if step["moved"] != moved:
        yield f"{moved} moved, and it says {step['moved']}"


def _history(frozen: Plan, plan: Plan, at: Fraction) -> Iterator[str]:
    for name, run in frozen.items():
        now = plan.get(name)
        if now is None:
            yield f"{name}, which had started, is gone"
        elif (now.start, now.end, now.resources) != (run.start, run.end, run.resources):
            yield f"{name} had started, and is not as it was"
        elif run.status == "abandoned" and now.status is None:
            yield f"{name} is no longer abandoned"
    for name, run in plan.items():
        if name not in frozen and run.start < at:
            yield f"{name} is planned for {run.start}, before the event at {at}"
        if name not in frozen and run.status is not None:
            yield f"{name} is {run.status}, and has not started"


def _presence(known: Known, plan: Plan) -> Iterator[str]:
    for name in plan.keys() - known.jobs.keys():
        yield f"nobody knows of {name}"
    for name, job in known.jobs.items():
        if job.candidate is None and name not in plan:
            yield f"{name} is missing"
    for goal in known.goals:
        members = known.candidate_jobs(goal)
        present = [name for name in members if name in plan]
        given_up = [name for name in present if plan[name].status == "abandoned"]
        if given_up and given_up != present:
            yield f"of candidate goal {goal} only {given_up} are abandoned"
        if not given_up and present and present != members:
            yield f"of candidate goal {goal} only {present} are there"
    for name, run in plan.items():
        job = known.jobs.get(name)
        if run.status is not None and (run.status != "abandoned" or not (job and job.candidate)):
            yield f"{name} is {run.status!r}"


def _own_times(known: Known, frozen: Plan, plan: Plan) -> Iterator[str]:
    for name, run in plan.items():
        job = known.jobs.get(name)
        if job is None:
            continue
        if run.end - run.start != job.length:
            yield f"{name} takes {run.end - run.start}, not {job.length}"
        limit = known.limit(job)
        if run.start < 0 or (limit is not None and run.end > limit and name not in frozen):
            yield f"{name} is at {run.start}–{run.end}, too early or too late"
        robots = [r for r in run.resources if r in known.robots]
        wanted = {job.station} - {None} | set(robots)
        if len(robots) != bool(known.robots) or dict(run.resources) != dict.fromkeys(wanted, 1):
            yield f"{name} holds {dict(run.resources)}"


def _orders(known: Known, plan: Plan) -> Iterator[str]:
    for before, after, least, most in known.lags:
        if before in plan and after in plan:
            gap = plan[after].start - plan[before].end
            if gap < least or (most is not None and gap > most):
                yield f"{gap} lie between {before} and {after}; allowed are {least} to {most}"


def _capacities(known: Known, plan: Plan) -> Iterator[str]:
    capacities = {**known.stations, **dict.fromkeys(known.robots, 1)}
    for resource, capacity in capacities.items():
        users = [run for run in plan.values() if run.resources.get(resource)]
        for instant in sorted({run.start for run in users}):
            used = sum(r.resources[resource] for r in users if r.start <= instant < r.end)
            if used > capacity:
                yield f"{used} of {resource} are used at {instant}; it has {capacity}"


def _stock(known: Known, plan: Plan) -> Iterator[str]:
    """A goal's cost is taken when its first action starts, and is not given back."""
    taken: dict[str, int] = defaultdict(int)
    for goal, said in known.goals.items():
        if any(name in plan for name in known.candidate_jobs(goal)):
            for name, amount in said.get("cost", {}).items():
                taken[name] += amount
    for name, amount in taken.items():
        if amount > known.stock.get(name, 0):
            yield f"{amount} of {name} are taken; there are {known.stock.get(name, 0)}"


def _value(
    known: Known, step: Document, frozen: Plan, plan: Plan, best: Best | None
) -> Iterator[str]:
    if best is None:
        yield "there is no continuation, and here is one"
        return
    finished, half_done = _finished(known, plan), half_done_goals(known, frozen)
    if sum(goal in finished for goal in half_done) != best.finished:
        yield f"of the goals begun, {half_done}, it should finish {best.finished}"
    reward, makespan = worth = _reached(known, plan)
    if _order(worth) < _order(best.worth):
        yield f"is worth {_worth(worth)}, which is better than possible: {_worth(best.worth)}"
    told = {o["name"]: time_of(o["value"]) for o in step["schedule"]["objective"]}
    for name, value in (("reward", reward), ("makespan", makespan)):
        if value is not None and told.get(name) != value:
            yield f"says that its {name} is {told.get(name)}, not {value}"
    if step["schedule"]["status"] == "optimal" and worth != best.worth:
        yield "is called optimal, and is not"


def _less(known: Known, step: Document, best: Best) -> str | None:
    """What is possible, where the step has less."""
    if step["schedule"]["status"] not in ("optimal", "feasible"):
        return f"nothing, and {_worth(best.worth)} is possible"
    worth = _reached(known, _plan(step["schedule"])[0])
    if _order(worth) <= _order(best.worth):
        return None
    return f"{_worth(worth)}, and {_worth(best.worth)} is possible"


def _finished(known: Known, plan: Plan) -> list[str]:
    """The candidate goals that are reached."""
    return [
        goal
        for goal in known.goals
        if (members := known.candidate_jobs(goal))
        and all(name in plan and plan[name].status is None for name in members)
    ]


def _reached(known: Known, plan: Plan) -> Worth:
    rewards = [known.goals[goal]["reward"] for goal in _finished(known, plan)]
    last = max((run.end for run in plan.values()), default=Fraction(0))
    return (sum(rewards) if known.goals else None, last)


def _order(worth: Worth) -> tuple[int, Fraction]:
    """Less is better."""
    return -(worth[0] or 0), worth[1]


def _worth(worth: Worth) -> str:
    return str(worth[1]) if worth[0] is None else f"reward {worth[0]}, makespan {worth[1]}"


def _shown(times: Sequence[Fraction]) -> str:
    return ", ".join(map(str, times))
