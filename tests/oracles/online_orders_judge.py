"""Judges executions about orders from their documents alone: task, events, and what steps say.

Approved is a step that keeps what has begun, plans nothing before the event, keeps all that is
known then, and is worth what the exact continuation is worth: as many half-done orders finished as
can be together, then the reward, then the makespan.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from oracles.online_orders_best import Best, Continuation, NotCompared, UndecidedError
from oracles.online_orders_kitchen import Kitchen, Plan, Run, plan_of

Document = dict[str, Any]


@dataclass
class Judgement:
    """What was found out about a step.

    `worse` says what is possible where an answer that is not called optimal is worth less, and
    `why_not` why nothing was compared. `half_done` are the orders that were, `given_up` those of
    them that are not finished, `unaffordable` new orders that nothing is left for.
    """

    faults: list[str] = field(default_factory=list)
    answered: bool = True
    infeasible: bool = False
    compared: bool = False
    worse: str | None = None
    why_not: str | None = None
    half_done: tuple[str, ...] = ()
    given_up: tuple[str, ...] = ()
    resumed: tuple[str, ...] = ()
    """Half-done orders that an earlier step gave up, and that can be finished after all."""
    new: tuple[str, ...] = ()
    unaffordable: tuple[str, ...] = ()
    earned: int = 0
    possible: int = 0


def judge(
    kitchen: Kitchen,
    begun: Plan,
    old: Plan,
    new: list[str],
    at: Fraction,
    step: Document,
    seconds: float = 60,
) -> Judgement:
    """Judges a step: `begun` is what has, as the event has it, of the `old` plan."""
    found = Judgement(half_done=tuple(kitchen.half_done(begun)), new=tuple(new))
    status = step["schedule"]["status"]
    found.infeasible = status == "infeasible"
    found.answered = status in ("optimal", "feasible")
    plan = plan_of(step["schedule"])
    if found.answered:
        found.faults += _faults(kitchen, begun, old, at, step, plan)
    elif not found.infeasible and status != "unknown":
        found.faults.append(f"there is no answer ({status})")
    finished = kitchen.finished(plan)
    found.given_up = tuple(g for g in found.half_done if g not in finished)
    found.resumed = tuple(
        g
        for g in found.half_done
        if g in finished and any(r.status for n, r in begun.items() if kitchen.group_of(n) == g)
    )
    if found.answered and sorted(step["abandoned"]) != sorted(found.given_up):
        found.faults.append(f"given up are {found.given_up}, and it says {step['abandoned']}")
    found.earned = sum(kitchen.groups[g]["reward"] for g in finished)
    try:
        model = Continuation(kitchen, begun, at, seconds)
        found.unaffordable = tuple(order for order in new if not model.can_have(order))
        best = model.best()
    except (NotCompared, UndecidedError) as error:
        found.why_not = str(error)
        return found
    found.compared = found.answered or found.infeasible
    if found.compared:
        _compare(found, kitchen, plan, step, best)
    return found


# --- what is worth what ---------------------------------------------------------------------------


def _compare(
    found: Judgement, kitchen: Kitchen, plan: Plan, step: Document, best: Best | None
) -> None:
    if best is None or found.infeasible:
        if best is not None:
            found.faults.append(f"called infeasible, and there is a continuation: {best}")
        if not found.infeasible:
            found.faults.append("an answer, and there is no continuation")
        return
    found.possible = best.reward
    kept = len(found.half_done) - len(found.given_up)
    if kept != best.finished:
        found.faults.append(
            f"{kept} of the half-done {found.half_done} are finished; {best.finished} can be"
        )
        return
    last = max((run.end for run in plan.values()), default=Fraction(0))
    reached = (-found.earned, Fraction(0) if best.makespan is None else last)
    possible = (-best.reward, best.makespan or Fraction(0))
    told = {o["name"]: o["value"] for o in step["schedule"]["objective"]}
    if told.get("reward") != found.earned or told.get("makespan", last) != last:
        found.faults.append(f"its reward is {found.earned}, its makespan {last}; it says {told}")
    said = f"reward {found.earned}, makespan {last}; possible is {best}"
    if reached < possible:
        found.faults.append(f"better than possible: {said}")
    elif reached > possible and step["schedule"]["status"] == "optimal":
        found.faults.append(f"called optimal: {said}")
    elif reached > possible:
        found.worse = said


# --- what must hold -------------------------------------------------------------------------------


def _faults(
    kitchen: Kitchen, begun: Plan, old: Plan, at: Fraction, step: Document, plan: Plan
) -> Iterator[str]:
    yield from _history(begun, old, at, step, plan)
    yield from _presence(kitchen, plan)
    later = {name: run for name, run in plan.items() if name not in begun}
    for name, run in later.items():
        yield from _own(kitchen, name, run, at)
    for before, after, least, most in kitchen.lags:
        if before not in plan or after not in plan or {before, after} & kitchen.over:
            continue
        gap = plan[after].start - plan[before].end
        if {before, after} & later.keys() and (gap < least or (most is not None and gap > most)):
            yield f"{gap} lie between {before} and {after}; allowed are {least} to {most}"
    yield from _capacities(kitchen, plan, later)
    yield from _stocks(kitchen, plan)


def _history(begun: Plan, old: Plan, at: Fraction, step: Document, plan: Plan) -> Iterator[str]:
    for name, run in begun.items():
        now = plan.get(name)
        if now is None:
            yield f"{name}, which had begun, is gone"
        elif (now.start, now.end, dict(now.resources)) != (run.start, run.end, dict(run.resources)):
            yield f"{name} had begun, and is not as it was: {now}, not {run}"
        elif (now.status == "cancelled") != (run.status == "cancelled"):
            yield f"{name} is {now.status}"
    moved = sum(
        name not in plan or (plan[name].start, plan[name].resources) != (run.start, run.resources)
        for name, run in old.items()
        if name not in begun
    )
    if step["moved"] != moved:
        yield f"{moved} moved, and it says {step['moved']}"
    parts = {
        "completed": {n for n, r in begun.items() if r.end <= at},
        "running": {n for n, r in begun.items() if r.end > at},
    }
    for key, names in parts.items():
        if sorted(step[key]) != sorted(names):
            yield f"{key} are {sorted(names)}, and it says {sorted(step[key])}"


def _presence(kitchen: Kitchen, plan: Plan) -> Iterator[str]:
    for name in plan.keys() - kitchen.actions.keys():
        yield f"nobody knows of {name}"
    for name in kitchen.actions:
        if kitchen.group_of(name) is None and name not in kitchen.over and name not in plan:
            yield f"{name} is missing"
    for order, said in kitchen.groups.items():
        here = [name for name in said["actions"] if name in plan]
        marked = [name for name in here if plan[name].status is not None]
        part = len(here) < len(said["actions"])
        if marked != (here if part else []) or any(plan[n].status != "abandoned" for n in marked):
            yield f"of {order} there are {here}, and {marked} are marked"


def _own(kitchen: Kitchen, name: str, run: Run, at: Fraction) -> Iterator[str]:
    if name in kitchen.over or run.status is not None:
        yield f"{name} is planned, and is over or {run.status}"
        return
    if run.start < at:
        yield f"{name} is planned for {run.start}, before the event at {at}"
    if run.end - run.start != kitchen.duration(name):
        yield f"{name} takes {run.end - run.start}, not {kitchen.duration(name)}"
    if run.end > kitchen.limit(name):
        yield f"{name} ends at {run.end}, after {kitchen.limit(name)}"
    uses = kitchen.actions[name]["uses"]
    wanted = {use["resource"] for use in uses if "resource" in use}
    robots = [r for r in run.resources if any(r in use.get("one_of", ()) for use in uses)]
    if len(robots) != sum("one_of" in use for use in uses) or dict(run.resources) != dict.fromkeys(
        wanted | set(robots), 1
    ):
        yield f"{name} holds {dict(run.resources)}"


def _capacities(kitchen: Kitchen, plan: Plan, later: Plan) -> Iterator[str]:
    """Where something that had not begun takes part."""
    for resource, said in kitchen.resources.items():
        if said.get("kind") == "reservoir":
            continue
        points = {run.start for run in plan.values()}
        points |= {t for w in kitchen.windows.get(resource, ()) for t in w[:2] if t is not None}
        for instant in sorted(points):
            users = {
                name: run.resources[resource]
                for name, run in plan.items()
                if run.resources.get(resource) and run.start <= instant < run.end
            }
            capacity = kitchen.capacity(resource, instant)
            if sum(users.values()) > capacity and users.keys() & later.keys():
                yield f"{sorted(users)} use {resource} at {instant}; it has {capacity}"


def _stocks(kitchen: Kitchen, plan: Plan) -> Iterator[str]:
    for stock, said in kitchen.resources.items():
        if said.get("kind") != "reservoir":
            continue
        changes = [c for name, run in plan.items() for c in kitchen.changes(name, run, stock)]
        for now in sorted({time for time, _ in changes}):
            level = said["initial"] + sum(amount for time, amount in changes if time <= now)
            if level < 0:
                yield f"{stock} is at {level} at {now}"
