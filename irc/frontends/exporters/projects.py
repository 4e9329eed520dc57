"""Exporters for projects: PSPLIB (`.sm`, `.mm`), RCPSP/max (`.sch`) and Patterson (`.rcp`).

Actions become numbers, in the order of the task. A project begins with one activity and ends with
one, both without duration; they are added where a task has none.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from irc.frontends.exporters.refusal import Refusals
from irc.model import Action, Mode, Precedence, Task
from irc.model.features import Feature

_COMMON = frozenset(
    [
        *(Feature.ZERO_DURATION, Feature.PRECEDENCE, Feature.RESOURCES, Feature.AMOUNTS),
        Feature.MAKESPAN,
    ]
)
_PSPLIB = _COMMON | {Feature.MODES, Feature.MODE_ELEMENTS, Feature.RESERVOIRS}
_MAX = _COMMON | {
    *(Feature.PRECEDENCE_TYPES, Feature.MIN_LAG, Feature.NEGATIVE_LAG, Feature.MAX_LAG),
    *(Feature.RELEASE, Feature.DEADLINE, Feature.FIXED_START, Feature.LATEST_START),
}


def write_psplib(task: Task) -> str:
    """The text of a PSPLIB file. Raises `InputError` with each element that it cannot say."""
    refusals = Refusals(task, "PSPLIB")
    refusals.require_features(_PSPLIB)
    table = _table(task, refusals)
    refusals.raise_any()
    afters = _successors(table)
    kinds = [f"{kind} {n}" for kind, n in table.columns]
    rows = [
        "PRECEDENCE RELATIONS:",
        "jobnr.    #modes  #successors   successors",
        *(
            _row([n, len(modes), len(afters[n]), *afters[n]])
            for n, modes in enumerate(table.modes, 1)
        ),
        _STARS,
        "REQUESTS/DURATIONS:",
        "jobnr. mode duration  " + "  ".join(kinds),
        "-" * 72,
        *(
            _row([*([n] if m == 1 else []), m, *mode])
            for n, modes in enumerate(table.modes, 1)
            for m, mode in enumerate(modes, 1)
        ),
        _STARS,
        "RESOURCEAVAILABILITIES:",
        "  " + "  ".join(kinds),
        _row(table.capacities),
        _STARS,
    ]
    head = [_STARS, f"jobs (incl. supersource/sink ):  {len(table.modes)}", _STARS]
    return "\n".join([*head, *rows]) + "\n"


def write_patterson(task: Task) -> str:
    """The text of a Patterson file. Raises `InputError` with each element that it cannot say."""
    refusals = Refusals(task, "the Patterson format")
    refusals.require_features(_COMMON)
    table = _table(task, refusals)
    refusals.raise_any()
    afters = _successors(table)
    rows = [_row([*modes[0], len(afters[n]), *afters[n]]) for n, modes in enumerate(table.modes, 1)]
    head = [_row([len(table.modes), len(table.columns)]), _row(table.capacities)]
    return "\n".join([*head[: 1 + bool(table.columns)], *rows]) + "\n"


def write_rcpsp_max(task: Task) -> str:
    """The text of an RCPSP/max file. Raises `InputError` with each element that it cannot say."""
    refusals = Refusals(task, "RCPSP/max")
    refusals.require_features(_MAX)
    table = _table(task, refusals)
    delays = _delays(task, table, refusals)
    refusals.raise_any()
    arcs: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for before, after, delay in delays:
        arcs[before].append((after, delay))
    rows = [_row([len(table.modes) - 2, len(table.columns), 0, 0])]
    for n in range(len(table.modes)):
        afters = [after - 1 for after, _ in arcs[n + 1]]
        lags = [f"[{lag}]" for _, lag in arcs[n + 1]]
        rows.append(_row([n, 1, len(afters), *afters, *lags]))
    rows += [_row([n, 1, *modes[0]]) for n, modes in enumerate(table.modes)]
    return "\n".join([*rows, *([_row(table.capacities)] if table.columns else [])]) + "\n"


_STARS = "*" * 72


def _row(values: Iterable[object]) -> str:
    return "\t".join(map(str, values))


@dataclass
class _Table:
    """A project in numbers. Activities count from 1; the first is the source, the last the sink.

    A mode is its duration and its request of each column; a column is ("R" or "N", its number).
    """

    columns: list[tuple[str, int]]
    capacities: list[int]
    numbers: dict[str, int]
    """The number of each action, by id."""
    modes: list[list[list[int]]] = field(default_factory=list)
    arcs: list[tuple[int, int, Precedence]] = field(default_factory=list)
    added: tuple[bool, bool] = (False, False)
    """Whether the source and the sink were added."""


def _table(task: Task, refusals: Refusals) -> _Table:
    columns = _columns(task, refusals)
    source, sink = _ends(task)
    ids = [action.id for action in task.actions]
    first = 1 + (source is None)
    table = _Table(
        [kind for kind, _, _ in columns],
        [capacity for _, capacity, _ in columns],
        {id: first + i for i, id in enumerate(ids)},
    )
    names = [id for _, _, id in columns]
    nothing = [[0] * (1 + len(names))]
    table.added = (source is None, sink is None)
    table.modes = [
        *([nothing] if source is None else []),
        *(_ways(action, i, names, refusals) for i, action in enumerate(task.actions)),
        *([nothing] if sink is None else []),
    ]
    table.arcs = [(table.numbers[p.before], table.numbers[p.after], p) for p in task.precedence]
    return table


_Column = tuple[tuple[str, int], int, str]
"""((kind, number), capacity, id) of a resource."""


def _columns(task: Task, refusals: Refusals) -> list[_Column]:
    """The resources: renewable ones, then those that are used up."""
    renewable: list[_Column] = []
    used_up: list[_Column] = []
    for k, resource in enumerate(task.resources):
        if resource.kind == "renewable":
            renewable.append((("R", len(renewable) + 1), resource.capacity, resource.id))
            continue
        if resource.max is not None or resource.min:
            message = f"resource {resource.id!r}: {refusals.format} has no limits of a stock"
            refusals.add(message, ("resources", k))
        used_up.append((("N", len(used_up) + 1), resource.initial or 0, resource.id))
    return [*renewable, *used_up]


def _ends(task: Task) -> tuple[str | None, str | None]:
    """The first action if it is a source, and the last one if it is a sink.

    A source takes no time, holds nothing, and is before each action without another predecessor.
    """
    entered = {p.after for p in task.precedence}
    left = {p.before for p in task.precedence}
    roots = [a for a in task.actions if a.id not in entered]
    leaves = [a for a in task.actions if a.id not in left]
    source = roots[0].id if roots == [*task.actions[:1]] and _is_dummy(roots[0]) else None
    sink = leaves[0].id if leaves == [*task.actions[-1:]] and _is_dummy(leaves[0]) else None
    return (source, sink) if source != sink else (None, None)


def _is_dummy(action: Action) -> bool:
    """Whether an activity only marks an instant, which nothing but its neighbours binds."""
    binding = (action.uses, action.consumes, action.release, action.start)
    return (
        action.duration == 0
        and not any(binding)
        and action.deadline is None
        and action.latest_start is None
    )


def _ways(action: Action, index: int, names: Sequence[str], refusals: Refusals) -> list[list[int]]:
    at = ("actions", index)
    if action.produces:
        message = f"action {action.id!r}: {refusals.format} has no stock that is produced"
        refusals.add(message, (*at, "produces"))
    ways: Sequence[Action | Mode] = action.modes or [action]
    found = []
    for m, way in enumerate(ways):
        place = (*at, "modes", m) if action.modes else at
        for name in ("produces", "conditions", "effects", "cost") if action.modes else ():
            if getattr(way, name) not in (None, ()):
                message = f"action {action.id!r}: {refusals.format} has no {name} of modes"
                refusals.add(message, (*place, name))
        duration = refusals.whole(way.duration, f"action {action.id!r}", (*place, "duration"))
        held: dict[str, int] = defaultdict(int)
        parts = [action, way] if action.modes else [action]
        for part in parts:
            for use in part.uses:
                held[use.alternatives[0]] += use.amount
            for change in getattr(part, "consumes", ()):
                held[change.resource] += change.amount
        found.append([duration, *(held[id] for id in names)])
    return found


def _successors(table: _Table) -> dict[int, list[int]]:
    """The successors of each activity; the added ends are connected."""
    afters: dict[int, list[int]] = defaultdict(list)
    for before, after, _ in table.arcs:
        if after not in afters[before]:
            afters[before].append(after)
    count = len(table.modes)
    inner = range(1 + table.added[0], count + 1 - table.added[1])
    if table.added[0]:
        entered = {after for _, after, _ in table.arcs}
        afters[1] = [n for n in inner if n not in entered] or [count]
    if table.added[1]:
        for n in inner:
            if not afters[n]:
                afters[n] = [count]
    return afters


def _delays(task: Task, table: _Table, refusals: Refusals) -> list[tuple[int, int, int]]:
    """(before, after, delay from start to start): precedences, limits of actions, added ends."""
    durations = {
        table.numbers[action.id]: table.modes[table.numbers[action.id] - 1][0][0]
        for action in task.actions
    }
    found = []
    for k, (before, after, edge) in enumerate(table.arcs):
        at = ("precedence", k)
        shift = durations[before] if edge.type.startswith("finish") else 0
        shift -= durations[after] if edge.type.endswith("finish") else 0
        least = refusals.whole(edge.min_lag, "min_lag", (*at, "min_lag"))
        found.append((before, after, shift + least))
        if edge.max_lag is not None:
            most = refusals.whole(edge.max_lag, "max_lag", (*at, "max_lag"))
            found.append((after, before, -shift - most))
    return [*found, *_limits(task, table, refusals), *_added_delays(table, found)]


def _limits(task: Task, table: _Table, refusals: Refusals) -> list[tuple[int, int, int]]:
    """The delays that say when an action, or the task, starts and ends."""
    found: list[tuple[int, int, int]] = []
    for i, action in enumerate(task.actions):
        number, at = table.numbers[action.id], ("actions", i)
        duration = table.modes[number - 1][0][0]
        name = f"action {action.id!r}"
        if action.release != 0:
            found.append((1, number, refusals.whole(action.release, name, (*at, "release"))))
        if action.deadline is not None:
            latest = refusals.whole(action.deadline, name, (*at, "deadline")) - duration
            found.append((number, 1, -latest))
        if action.latest_start is not None:
            latest = refusals.whole(action.latest_start, name, (*at, "latest_start"))
            found.append((number, 1, -latest))
        if action.start is not None and number != 1:
            start = refusals.whole(action.start, name, (*at, "start"))
            found += [(1, number, start), (number, 1, -start)]
    if task.deadline is not None:
        latest = refusals.whole(task.deadline, "the task", ("deadline",))
        found.append((len(table.modes), 1, -latest))
    return found


def _added_delays(
    table: _Table, found: Sequence[tuple[int, int, int]]
) -> list[tuple[int, int, int]]:
    """The delays from an added source and to an added sink."""
    count = len(table.modes)
    inner = range(1 + table.added[0], count + 1 - table.added[1])
    begin = [(1, n, 0) for n in inner] if table.added[0] else []
    end = [(n, count, table.modes[n - 1][0][0]) for n in inner] if table.added[1] else []
    return begin + end
