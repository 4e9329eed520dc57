"""The objectives on ends in a CP-SAT model: due dates, and flow time.

Each variable is bounded from below alone, which is enough where its sum is minimised.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from typing import Any, NamedTuple

from irc_cpsat.encoding.builder import Builder, Expression, Literal, name_of


class _Ending(NamedTuple):
    """Activities that end something together: an action, or a group that is present."""

    name: str
    members: tuple[int, ...]
    present: Literal | None
    due: int | None
    entered: int
    weight: int
    is_group: bool


def dated_values(builder: Builder, names: Collection[str]) -> dict[str, Expression]:
    """The expressions of those objectives that have to do with due dates or flow time."""
    wanted = [name for name in _VALUES if name in names]
    if not wanted:
        return {}
    endings = list(_endings(builder))
    dated = [e for e in endings if e.due is not None and e.weight]
    return {
        name: _VALUES[name](builder, endings if name == "flow_time" else dated) for name in wanted
    }


def _endings(builder: Builder) -> Iterator[_Ending]:
    problem = builder.problem
    for i, activity in enumerate(problem.activities):
        details, present = activity.details, builder.present[i]
        yield _Ending(
            name_of(activity),
            (i,),
            present,
            details.due,
            details.entered or 0,
            details.weight,
            False,
        )
    for group, literal in zip(problem.groups, builder.groups, strict=True):
        if group.members:
            entered = min(problem.activities[i].details.entered or 0 for i in group.members)
            yield _Ending(group.id, group.members, literal, group.due, entered, group.weight, True)


def _tardiness(builder: Builder, endings: list[_Ending]) -> Expression:
    late = [e.weight * _beyond(builder, e, e.due or 0, f"late {e.name}") for e in endings]
    return sum(late) if late else 0


def _beyond(builder: Builder, ending: _Ending, time: int, name: str) -> Expression:
    """A variable that is at least 0, and at least the end less a time."""
    late = builder.model.new_int_var(0, max(0, builder.horizon - time), name)
    for i in ending.members:
        _where_present(ending, builder.model.add(late >= builder.end(i) - time))
    return late


def _where_present(ending: _Ending, constraint: Any, *also: Any) -> None:
    literals = [*([] if ending.present is None else [ending.present]), *also]
    if literals:
        constraint.only_enforce_if(*literals)


def _tardy(builder: Builder, endings: list[_Ending]) -> Expression:
    tardy = []
    for ending in endings:
        late = builder.model.new_bool_var(f"tardy {ending.name}")
        for i in ending.members:
            in_time = builder.model.add(builder.end(i) <= (ending.due or 0))
            _where_present(ending, in_time, ~late)
        tardy.append(ending.weight * late)
    return sum(tardy) if tardy else 0


def _max_tardiness(builder: Builder, endings: list[_Ending]) -> Expression:
    most = [e.weight * max(0, builder.horizon - (e.due or 0)) for e in endings]
    worst = builder.model.new_int_var(0, max(most, default=0), "max tardiness")
    for ending in endings:
        for i in ending.members:
            late = ending.weight * (builder.end(i) - (ending.due or 0))
            _where_present(ending, builder.model.add(worst >= late))
    return worst


def _earliness(builder: Builder, endings: list[_Ending]) -> Expression:
    """For a group it is its last end that counts, so some member must end that late."""
    total = []
    for ending in endings:
        due = ending.due or 0
        early = builder.model.new_int_var(0, max(0, due), f"early {ending.name}")
        if len(ending.members) == 1:
            _where_present(ending, builder.model.add(early >= due - builder.end(ending.members[0])))
        else:
            last = [builder.model.new_bool_var("") for _ in ending.members]
            for i, literal in zip(ending.members, last, strict=True):
                _where_present(ending, builder.model.add(early >= due - builder.end(i)), literal)
            builder.model.add_bool_or(
                [*last, *([] if ending.present is None else [~ending.present])]
            )
        total.append(ending.weight * early)
    return sum(total) if total else 0


def _flow_time(builder: Builder, endings: list[_Ending]) -> Expression:
    grouped = {i for group in builder.problem.groups for i in group.members}
    total: list[Expression] = []
    for ending in endings:
        if not ending.weight or (not ending.is_group and ending.members[0] in grouped):
            continue
        if ending.present is None and len(ending.members) == 1:
            (i,) = ending.members
            total.append(ending.weight * (builder.end(i) - ending.entered))
            continue
        flow = _beyond(builder, ending, ending.entered, f"flow time {ending.name}")
        total.append(ending.weight * flow)
    return sum(total) if total else 0


_VALUES: dict[str, Callable[[Builder, list[_Ending]], Expression]] = {
    "tardiness": _tardiness,
    "tardy": _tardy,
    "max_tardiness": _max_tardiness,
    "earliness": _earliness,
    "flow_time": _flow_time,
}
