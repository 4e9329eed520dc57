"""Builds the IR task of a Robo instance.

An item whose state changes is a state variable. Every processing needs the state before it and
gives the state after it, so that state alone orders the processing of an item, and the stacking of
an item waits until it is done. Stack order and lags become precedence.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from irc.frontends.importers.instances import without_empty
from irc.frontends.importers.robo.document import Candidate, Lag, RoboTask
from irc.frontends.importers.robo.kitchen import (
    STACK,
    Item,
    Kitchen,
    ProcessingStep,
    UnreachableError,
    action_id,
    steps_to,
)
from irc.model import Task

_LONGEST_ORDER = 500
"""Limit on dishes with optional items, whose order needs a precedence for each pair of items."""


@dataclass(frozen=True)
class Work:
    """The work on one item: its processing, and its stacking if it is stacked."""

    item: Item
    steps: tuple[ProcessingStep, ...]
    stacked: bool

    @property
    def actions(self) -> tuple[str, ...]:
        """The ids of its actions, in order."""
        ids = [action_id(step.action, step.item) for step in self.steps]
        return (*ids, action_id(STACK, self.item.name)) if self.stacked else tuple(ids)


def robo_task(robo: RoboTask) -> Task:
    """The IR task of an instance. Raises `InputError` if a goal cannot be reached."""
    candidates = {candidate.item: candidate for candidate in robo.candidates}
    works = _all_work(robo, candidates)
    _check(robo, works)
    robo.part.faults.raise_any()
    return Task.model_validate(
        without_empty(
            {
                "name": robo.id,
                "metadata": {"id": robo.id, **robo.metadata, **_left_out(robo, works)},
                **({} if robo.deadline is None else {"deadline": robo.deadline}),
                "resources": [*_stations(robo.kitchen, works), *_stock(robo)],
                "state": [state_variable(work) for work in works if work.steps],
                "actions": [
                    action
                    for work in works
                    for action in actions(work, robo.kitchen, candidates.get(work.item.name))
                ],
                "precedence": [*stack_order(robo.stack_order, candidates), *lags(robo.lags)],
                "groups": [
                    group(candidates[work.item.name], work)
                    for work in works
                    if work.item.name in candidates
                ],
                "goals": [
                    {"var": work.item.name, "value": work.steps[-1].after}
                    for work in works
                    if work.steps and work.item.name not in candidates
                ],
                "objective": ["maximize_reward", "minimize_makespan"]
                if robo.candidates
                else "minimize_makespan",
            }
        )
    )


def _all_work(robo: RoboTask, candidates: Mapping[str, Candidate]) -> list[Work]:
    wanted = {**robo.required, **{c.item: c.state for c in candidates.values()}}
    works = []
    for name, item in robo.items.items():
        stacked = name in robo.stack_order
        if name not in wanted and not stacked:
            continue
        try:
            steps = steps_to(item, wanted.get(name, item.state))
        except UnreachableError as error:
            part = candidates[name].part if name in candidates else _goal_part(robo, name)
            part.fault(str(error))
            continue
        works.append(Work(item, steps, stacked))
    return works


def _goal_part(robo: RoboTask, name: str) -> Any:
    part = robo.part
    for key in ("goal", "required_states", name):
        part = part.child(key, part.value[key])
    return part


def state_variable(work: Work) -> dict[str, Any]:
    """The state variable of an item, with the states of its steps in their order."""
    return {
        "id": work.item.name,
        "values": [work.item.state, *(step.after for step in work.steps)],
        "initial": work.item.state,
    }


def actions(work: Work, kitchen: Kitchen, candidate: Candidate | None) -> list[dict[str, Any]]:
    """The actions of an item. Those of a candidate goal are optional, as their group decides."""
    made = [processing(step, kitchen) for step in work.steps]
    if work.stacked:
        made.append(stacking(work.item.name, work.steps[-1].after if work.steps else None, kitchen))
    if candidate is not None:
        take(candidate.cost, made[0])
    return made


def processing(step: ProcessingStep, kitchen: Kitchen) -> dict[str, Any]:
    """The action of a step, which needs the state before it and gives the state after it."""
    return {
        "id": action_id(step.action, step.item),
        "duration": kitchen.durations[step.action],
        "uses": [{"resource": step.station}, *robot_use(kitchen)],
        "conditions": [{"at": "start", "var": step.item, "value": step.before}],
        "effects": [{"at": "end", "var": step.item, "value": step.after}],
    }


def stacking(item: str, state: str | None, kitchen: Kitchen) -> dict[str, Any]:
    """The action that puts an item on a dish, after it has its wanted state."""
    stack: dict[str, Any] = {"id": action_id(STACK, item), "duration": kitchen.durations[STACK]}
    if kitchen.robots:
        stack["uses"] = robot_use(kitchen)
    if state is not None:
        stack["conditions"] = [{"at": "start", "var": item, "value": state}]
    return stack


def take(cost: Mapping[str, int], action: dict[str, Any]) -> None:
    """Lets an action consume the cost of a goal from the stock."""
    if any(cost.values()):
        action["consumes"] = [{"resource": name, "amount": n} for name, n in cost.items() if n]


def robot_use(kitchen: Kitchen) -> list[dict[str, Any]]:
    """The use of every action besides its station: one of the robots, if there are any."""
    if not kitchen.robots:
        return []
    if len(kitchen.robots) == 1:
        return [{"resource": kitchen.robots[0]}]
    return [{"one_of": list(kitchen.robots)}]


def stack_order(items: Sequence[str], optional: Container[str] = ()) -> list[dict[str, Any]]:
    """The precedences of a dish: each item after the previous one, and after those before it if
    the previous one is optional.
    """
    made = []
    for below, item in enumerate(items):
        for above in items[below + 1 :]:
            made.append({"before": action_id(STACK, item), "after": action_id(STACK, above)})
            if above not in optional:
                break
    return made


def lags(found: Iterable[Lag]) -> list[dict[str, Any]]:
    """The temporal constraints as precedence."""
    return [
        {
            "before": lag.before,
            "after": lag.after,
            "min_lag": lag.min_lag,
            **({} if lag.max_lag is None else {"max_lag": lag.max_lag}),
        }
        for lag in found
    ]


def check_lags(found: Iterable[Lag], present: Iterable[str]) -> None:
    """Reports temporal constraints between actions that no goal needs."""
    known = set(present)
    for lag in found:
        for end in (lag.before, lag.after):
            if end not in known:
                lag.part.fault(f"no goal needs the action {end!r}, so it cannot be timed")


def group(candidate: Candidate, work: Work) -> dict[str, Any]:
    """The group of a candidate goal, which has all of its actions or none."""
    return {
        "id": candidate.id,
        "actions": list(work.actions),
        "required": False,
        "reward": candidate.reward,
    }


def _stations(kitchen: Kitchen, works: Iterable[Work]) -> list[dict[str, Any]]:
    used = {step.station for work in works for step in work.steps}
    return [
        {"id": station, "capacity": capacity}
        for station, capacity in kitchen.stations.items()
        if station in used
    ] + [{"id": robot} for robot in kitchen.robots]


def _stock(robo: RoboTask) -> list[dict[str, Any]]:
    """The reservoirs of the stocks that are consumed; others have no effect and are left out."""
    consumed = {name for c in robo.candidates for name, amount in c.cost.items() if amount}
    return [
        {"id": name, "kind": "reservoir", "initial": amount}
        for name, amount in robo.stock.items()
        if name in consumed
    ]


def _left_out(robo: RoboTask, works: Iterable[Work]) -> dict[str, Any]:
    """The parts of the kitchen that the task does not use, for the metadata."""
    works = list(works)
    worked_on = {work.item.name for work in works}
    used = {step.station for work in works for step in work.steps}
    unused = {
        "items_without_a_goal": [name for name in robo.items if name not in worked_on],
        "unused_stations": [name for name in robo.kitchen.stations if name not in used],
    }
    return {key: names for key, names in unused.items() if names}


def _check(robo: RoboTask, works: Sequence[Work]) -> None:
    """Reports stations and durations that the work of an instance needs and that are missing."""
    part = robo.part
    kitchen = robo.kitchen
    for work in works:
        for step in work.steps:
            if step.station not in kitchen.stations:
                part.fault(f"there is no station {step.station!r} to {step.action} {step.item!r}")
        needed = {step.action for step in work.steps} | ({STACK} if work.stacked else set())
        for action in sorted(needed - kitchen.durations.keys()):
            part.fault(f"'action_durations' has no {action!r}, which {work.item.name!r} needs")
    if robo.candidates and len(robo.stack_order) > _LONGEST_ORDER:
        found = len(robo.stack_order)
        part.fault(f"with candidate goals at most {_LONGEST_ORDER} items are stacked, not {found}")
    by_item = {work.item.name: work for work in works}
    for candidate in robo.candidates:
        if candidate.item in by_item and not by_item[candidate.item].actions:
            candidate.part.fault("it is fulfilled from the start, so there is nothing to choose")
        for name in candidate.cost.keys() - robo.stock.keys():
            candidate.part.fault(f"'inventory_limits' has no {name!r}, which this goal costs")
        asked = robo.required.get(candidate.item, candidate.state)
        if asked != candidate.state:
            candidate.part.fault(
                f"'required_states' wants {candidate.item!r} {asked!r}, not {candidate.state!r}"
            )
    names = Counter([*kitchen.stations, *kitchen.robots, *robo.stock])
    for name, count in names.items():
        if count > 1:
            part.fault(f"{name!r} names two of its stations, robots and stocks")
    check_lags(robo.lags, [action for work in works for action in work.actions])
