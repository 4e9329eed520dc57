"""The validator against a naive second one, on small random tasks and schedules.

Tasks are built around a schedule so that it is valid by construction; then either may be damaged.
The naive check below is written from docs/semantics.md: quadratic loops, and every assignment of
ranks tried in turn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations, product
from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from irc.model import Action, DurationRange, StateGoal, Task
from irc.model.quantities import Number
from irc.schedule import Entry
from oracles.exhaustive import Judge, Placed, Way, World, fits

# The naive validator: for each rule of docs/semantics.md, whether it is broken.


def bounds_of(action: Action, entry: Entry) -> tuple[Number, Number] | None:
    duration = action.duration
    if action.modes:
        chosen = [mode for mode in action.modes if mode.id == entry.mode]
        if not chosen:
            return None
        duration = chosen[0].duration
    elif entry.mode is not None:
        return None
    if isinstance(duration, DurationRange):
        return duration.min, duration.max  # type: ignore[return-value]
    return duration, duration  # type: ignore[return-value]


def rule_1(task: Task, entries: Sequence[Entry]) -> bool:
    known = {action.id: action for action in task.actions}
    if any(entry.id not in known or entry.status for entry in entries):
        return False
    soft = {name for group in task.groups if not group.required for name in group.actions}
    for action in known.values():
        own = sorted((e for e in entries if e.id == action.id), key=lambda e: e.occurrence)
        least, most = action.occurrence_bounds
        if len(own) < least and action.id not in soft:
            return False
        if most is not None and len(own) > most:
            return False
        if [e.occurrence for e in own] != list(range(1, len(own) + 1)):
            return False
        for one, two in combinations(own, 2):
            if one.start > two.start:
                return False
            if one.start < two.end and two.start < one.end:
                return False
    present = {entry.id for entry in entries}
    for group in task.groups:
        count = sum(name in present for name in group.actions)
        if count != len(group.actions) and (count or group.required):
            return False
    return True


def rule_2(task: Task, entries: Sequence[Entry]) -> bool:
    known = {action.id: action for action in task.actions}
    for entry in entries:
        action = known.get(entry.id)
        if action is None:
            continue
        bounds = bounds_of(action, entry)
        if bounds is None or not bounds[0] <= entry.end - entry.start <= bounds[1]:
            return False
        if entry.start < max(0, task.number(action.release)):
            return False
        if action.start is not None and entry.start != action.start:
            return False
        if action.earliest_end is not None and entry.end < task.number(action.earliest_end):
            return False
        if action.latest_start is not None and entry.start > task.number(action.latest_start):
            return False
        deadlines = [action.deadline, task.deadline]
        deadlines += [group.deadline for group in task.groups if entry.id in group.actions]
        if any(d is not None and entry.end > task.number(d) for d in deadlines):
            return False
    return True


Point = tuple[Number, int]


def end_points(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int] | None = None
) -> Iterator[tuple[Entry, Action, Point, Point]]:
    known = {action.id: action for action in task.actions}
    for i, entry in enumerate(entries):
        if entry.id in known:
            start = (entry.start, ranks[i, "start"] if ranks else entry.rank)
            end_rank = entry.rank if entry.end_rank is None else entry.end_rank
            yield entry, known[entry.id], start, (entry.end, ranks[i, "end"] if ranks else end_rank)


def rule_3(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int] | None = None
) -> bool:
    points = {e.id: (start, end) for e, _, start, end in end_points(task, entries, ranks)}
    for p in task.precedence:
        if p.before not in points or p.after not in points:
            continue
        base = points[p.before][p.type.startswith("finish")]
        point = points[p.after][p.type.endswith("finish")]
        if point < (base[0] + task.number(p.min_lag), base[1]):
            return False
        if p.max_lag is not None and point[0] > base[0] + task.number(p.max_lag):
            return False
    return True


def explained(task: Task, action: Action, entry: Entry) -> bool:
    uses = action.uses + tuple(u for m in action.modes if m.id == entry.mode for u in m.uses)
    for choice in product(*(use.alternatives for use in uses)):
        total: dict[str, int] = {}
        for name, use in zip(choice, uses, strict=True):
            total[name] = total.get(name, 0) + use.amount
        if total == dict(entry.resources):
            return True
    return False


NO_RANKS: dict[tuple[int, str], int] = {}


def rule_4(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int] = NO_RANKS
) -> bool:
    known = {action.id: action for action in task.actions}
    for entry in entries:
        if entry.id in known and not explained(task, known[entry.id], entry):
            return False
    for resource in task.resources:
        if resource.kind != "renewable":
            continue
        instants = {e.start for e in entries}
        instants |= {task.number(t) for w in resource.availability for t in (w.from_, w.to)}
        last = 1 + max(ranks.values(), default=0)
        for t, rank in product(instants, range(last + 1)):
            # Behind all ranks of an instant there is what the time says; before, what touches it
            # by ranks alone may have what there was until then.
            capacities = [resource.capacity, resource.capacity]
            for w in resource.availability:
                if task.number(w.from_) <= t < task.number(w.to):
                    capacities[0] = w.capacity
                if task.number(w.from_) < t <= task.number(w.to):
                    capacities[1] = w.capacity
            used = sum(
                e.resources.get(resource.id, 0)
                for i, e in enumerate(entries)
                if e.id in known
                and e.start < e.end
                and (e.start, ranks.get((i, "start"), 0)) <= (t, rank)
                and (t, rank) < (e.end, ranks.get((i, "end"), 0))
            )
            if used > (capacities[0] if rank == last else max(capacities)):
                return False
    return True


def rule_5(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int] = NO_RANKS
) -> bool:
    levels = {r.id: r.initial for r in task.resources if r.kind == "reservoir"}
    happenings: dict[Point, dict[int, dict[str, int]]] = {}
    for i, (_, action, start, end) in enumerate(end_points(task, entries, ranks)):
        for sign, default, parts in ((-1, "start", action.consumes), (1, "end", action.produces)):
            for part in parts:
                point = start if (part.at or default) == "start" else end
                its = happenings.setdefault(point, {}).setdefault(i, {})
                its[part.resource] = its.get(part.resource, 0) + sign * part.amount
    if not any(time <= 0 for time, _ in happenings) and not stock_is_within(task, levels):
        return False
    for point in sorted(happenings):
        if not some_order_does(task, levels, list(happenings[point].values())):
            return False
        for change in happenings[point].values():
            levels = added(levels, change)
    return True


def added(levels: dict[str, int], change: dict[str, int]) -> dict[str, int]:
    return {name: level + change.get(name, 0) for name, level in levels.items()}


def stock_is_within(task: Task, levels: dict[str, int]) -> bool:
    return all(
        r.min <= levels[r.id] and (r.max is None or levels[r.id] <= r.max)
        for r in task.resources
        if r.kind == "reservoir"
    )


def some_order_does(task: Task, levels: dict[str, int], changes: list[dict[str, int]]) -> bool:
    if not changes:
        return True
    for k, change in enumerate(changes):
        following = added(levels, change)
        rest = changes[:k] + changes[k + 1 :]
        if stock_is_within(task, following) and some_order_does(task, following, rest):
            return True
    return False


def end_is_chosen(action: Action) -> bool:
    """A range of one value leaves nothing to choose."""
    duration = action.duration
    return isinstance(duration, DurationRange) and duration.min != duration.max


def past_comes_first(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int]
) -> bool:
    """At the instant of a change of the world: what ended, then it, then what starts."""
    concerned = [
        (
            action.id.startswith("p at"),
            start,
            start if end_is_chosen(action) else end,
        )
        for _, action, start, end in end_points(task, entries, ranks)
        if action.conditions or action.effects or action.consumes or action.produces
    ]
    for is_change, change, _ in concerned:
        for other, start, end in concerned if is_change else ():
            if start[0] < end[0] == change[0] and end > change:
                return False
            if not other and start[0] == change[0] and start < change:
                return False
    return True


def rule_6_and_7(task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int]) -> bool:
    present = {entry.id for entry in entries}
    if any(isinstance(goal, str) and goal not in present for goal in task.goals):
        return False
    reads: list[tuple[str, Point, str, Any]] = []
    writes: list[tuple[str, Point, str, Any]] = []
    holds: list[tuple[Point, Point, str, Any]] = []
    for i, (entry, action, start, end) in enumerate(end_points(task, entries, ranks)):
        bounds = bounds_of(action, entry)
        if bounds is not None and bounds[0] <= end[0] - start[0] <= bounds[1]:
            if end < (start[0] + bounds[0], start[1]):
                return False
            if end > (start[0] + bounds[1], start[1]):
                return False
        for c in action.conditions:
            if c.at == "all" and start != end:
                holds.append((start, end, c.var, c.value))
            else:
                point = end if c.at == "end" else start
                reads.append((f"{i}{point}", point, c.var, c.value))
        for e in action.effects:
            point = end if e.at == "end" else start
            writes.append((f"{i}{point}", point, e.var, e.value))
    for who, point, var, value in writes:
        for other, point_2, var_2, value_2 in writes:
            if point == point_2 and var == var_2 and (who != other or value != value_2):
                return False
        for other, point_2, var_2, _ in reads:
            if point == point_2 and var == var_2 and who != other:
                return False
    initial = {variable.id: variable.start_value for variable in task.state}

    def before(point: Point, var: str) -> Any:
        earlier = [(p, value) for _, p, v, value in writes if v == var and p < point]
        return max(earlier, key=lambda pair: pair[0])[1] if earlier else initial[var]

    if any(before(point, var) != value for _, point, var, value in reads):
        return False
    for start, end, var, value in holds:
        inside = [p for _, p, v, _ in writes if v == var and start < p < end]
        if any(before(p, var) != value for p in [*inside, end]):
            return False
    never: Point = (max([0, *(e.end for e in entries)]) + 1, 0)
    return all(
        before(never, goal.var) == goal.value for goal in task.goals if isinstance(goal, StateGoal)
    )


def some_ranks_do(task: Task, entries: Sequence[Entry]) -> bool:
    """Rules 3 to 7 under some ranks; as many different ones as there are nodes are enough."""
    known = {action.id: action for action in task.actions}
    nodes: list[list[tuple[int, str]]] = []
    own = [entry for entry in entries if entry.id in known]
    for i, entry in enumerate(own):
        bounds = bounds_of(known[entry.id], entry)
        if bounds is None or bounds[0] == bounds[1]:
            nodes.append([(i, "start"), (i, "end")])
        else:
            nodes += [[(i, "start")], [(i, "end")]]
    for values in product(range(len(nodes)), repeat=len(nodes)):
        ranks = {key: rank for keys, rank in zip(nodes, values, strict=True) for key in keys}
        if all_rules_of_ranks(task, own, ranks):
            return True
    return False


def all_rules_of_ranks(
    task: Task, entries: Sequence[Entry], ranks: dict[tuple[int, str], int]
) -> bool:
    return (
        rule_3(task, entries, ranks)
        and rule_6_and_7(task, entries, ranks)
        and past_comes_first(task, entries, ranks)
        and rule_4(task, entries, ranks)
        and rule_5(task, entries, ranks)
    )


def keeps_every_rule(task: Task, entries: Sequence[Entry]) -> bool:
    """Whether a schedule is valid, by all that `oracles.exhaustive` knows; none has a status."""
    if any(entry.id not in {a.id for a in task.actions} or entry.status for entry in entries):
        return False
    moments = [0, *(moment for e in entries for moment in (e.start, e.end))]
    if min(moments) < 0:
        return False
    world = World(task, 10**9, moments)
    listed = sorted(entries, key=lambda e: (e.id, e.occurrence))
    options = [list(ways_of(world, entry)) for entry in listed]
    return any(placing_is_valid(world, listed, ways) for ways in product(*options))


def ways_of(world: World, entry: Entry) -> Iterator[Way]:
    """The ways to carry out an action that an entry can mean."""
    (action,) = (a for a in world.task.actions if a.id == entry.id)
    for way in world.ways(action):
        if (way.mode and way.mode.id) == entry.mode and way.holds == dict(entry.resources):
            yield way


def is_closed_time(world: World, placed: Placed, stated: Number) -> bool:
    return stated == world.closed_time(placed.way, placed.start, placed.end) * world.tick


def placing_is_valid(world: World, entries: Sequence[Entry], ways: Sequence[Way]) -> bool:
    placed: list[Placed] = []
    there: dict[str, list[Way]] = {}
    for entry, way in zip(entries, ways, strict=True):
        there.setdefault(entry.id, []).append(way)
        if entry.occurrence != len(there[entry.id]):
            return False
        start, end = world.ticks(entry.start), world.ticks(entry.end)
        new = Placed(way, entry.occurrence, start, end)
        if not world.allows(way, start, end) or not fits(world, new, placed):
            return False
        if entry.paused and not (way.pauses and is_closed_time(world, new, entry.paused)):
            return False
        placed.append(new)
    for action in world.task.actions:
        least, most = world.counts(action)
        if not least <= len(there.get(action.id, ())) <= most:
            return False
    if not world.presence_holds(there) or not world.couplings_hold(there):
        return False
    ranks = [(e.rank, e.rank if e.end_rank is None else e.end_rank) for e in entries]
    given = any(rank for pair in ranks for rank in pair)
    return Judge(world, placed).accepts(ranks if given else None)


# Tasks around schedules.

TIMES = st.one_of(st.integers(0, 5), st.sampled_from([Fraction(1, 3), Fraction(7, 2)]))
KINDS = ["finish-start", "start-start", "finish-finish", "start-finish"]
Draw = Any


def text(value: Number) -> Any:
    return value if isinstance(value, int) else str(value)


def draw_precedence(draw: Draw, entries: Sequence[Entry]) -> list[dict[str, Any]]:
    single = [e for e in entries if sum(o.id == e.id for o in entries) == 1]
    if len(single) < 2:
        return []
    found = []
    for _ in range(draw(st.integers(0, 3))):
        before, after = draw(st.permutations(single))[:2]
        kind = draw(st.sampled_from(KINDS))
        base = before.end if kind.startswith("finish") else before.start
        time = after.end if kind.endswith("finish") else after.start
        gap = time - base
        edge = {"before": before.id, "after": after.id, "type": kind}
        edge["min_lag"] = text(gap - draw(st.integers(0, 2)))
        if draw(st.booleans()):
            edge["max_lag"] = text(gap + draw(st.integers(0, 1)))
        found.append(edge)
    return found


def draw_action(draw: Draw, name: str, own: Sequence[Entry]) -> dict[str, Any]:
    lengths = {e.end - e.start for e in own}
    action: dict[str, Any] = {"id": name, "duration": text(min(lengths))}
    if len(lengths) > 1 or draw(st.booleans()):
        slack = draw(st.integers(0, 1))
        low = max(0, min(lengths) - slack)
        action["duration"] = {"min": text(low), "max": text(max(lengths) + slack)}
    if len(own) == 1 and draw(st.booleans()):
        # The same duration, now that of a mode.
        fast = {"id": "fast", "duration": action.pop("duration"), "uses": []}
        action["modes"] = [fast, {"id": "slow", "duration": 9, "uses": []}]
    if len(own) > 1:
        action["occurs"] = {"min": draw(st.integers(0, len(own))), "max": len(own)}
    if draw(st.booleans()):
        action["release"] = text(min(e.start for e in own))
        action["deadline"] = text(max(e.end for e in own))
    if draw(st.booleans()):
        action["latest_start"] = text(max(e.start for e in own))
    if len(own) == 1 and draw(st.booleans()):
        action["start"] = text(own[0].start)
    if draw(st.booleans()):
        action["earliest_end"] = text(min(e.end for e in own))
    return action


@st.composite
def tasks_and_schedules(draw: Draw) -> tuple[Task, list[Entry]]:
    """A task, and entries that are valid for all its rules but state."""
    entries: list[Entry] = []
    actions = []
    for name in "abcd"[: draw(st.integers(1, 4))]:
        own: list[Entry] = []
        for number in range(1, draw(st.sampled_from([1, 1, 1, 2])) + 1):
            start = draw(TIMES) + (own[-1].end if own else 0)
            own.append(Entry(name, start, start + draw(TIMES), {}, None, number))
        action = draw_action(draw, name, own)
        uses, held = draw_uses(draw)
        action["uses"] = uses
        if draw(st.booleans()):
            kind = draw(st.sampled_from(["consumes", "produces"]))
            action[kind] = [{"resource": "stock", "amount": draw(st.integers(1, 2))}]
            if draw(st.booleans()):
                action[kind][0]["at"] = draw(st.sampled_from(["start", "end"]))
        mode = "fast" if "modes" in action else None
        entries += [Entry(e.id, e.start, e.end, held, mode, e.occurrence) for e in own]
        actions.append(action)
    document = {
        "actions": actions,
        "precedence": draw_precedence(draw, entries),
        "resources": draw_resources(draw, actions, entries),
        "groups": draw_groups(draw, entries),
        "deadline": text(max(e.end for e in entries) + draw(st.integers(0, 1))),
    }
    return Task.model_validate(document), entries


def draw_uses(draw: Draw) -> tuple[list[dict[str, Any]], dict[str, int]]:
    uses: list[dict[str, Any]] = []
    held: dict[str, int] = {}
    for _ in range(draw(st.integers(0, 3))):
        pool = draw(st.sampled_from([["x"], ["x", "y"], ["y", "z"], ["x", "y", "z"]]))
        amount = draw(st.sampled_from([1, 1, 2]))
        name = draw(st.sampled_from(pool))
        held[name] = held.get(name, 0) + amount
        use: dict[str, Any] = {"one_of": pool} if len(pool) > 1 else {"resource": name}
        uses.append({**use, "amount": amount})
    return uses, held


def draw_resources(
    draw: Draw, actions: list[dict[str, Any]], entries: Sequence[Entry]
) -> list[dict[str, Any]]:
    def peak(name: str, low: Number, high: Number) -> int:
        instants = [low, *(e.start for e in entries if low <= e.start < high)]
        return max(
            sum(e.resources.get(name, 0) for e in entries if e.start <= t < e.end) for t in instants
        )

    resources = []
    for name in "xyz":
        resource = {"id": name, "capacity": peak(name, 0, 100)}
        if draw(st.booleans()):
            low = draw(TIMES)
            high = low + draw(st.integers(1, 3))
            window = {"from": text(low), "to": text(high), "capacity": peak(name, low, high)}
            resource["availability"] = [window]
        resources.append(resource)
    levels = stock_levels(actions, entries)
    return [
        *resources,
        {"id": "stock", "kind": "reservoir", "min": min(levels), "max": max(levels)},
    ]


def stock_levels(actions: list[dict[str, Any]], entries: Sequence[Entry]) -> list[int]:
    changes = []
    for entry in entries:
        (action,) = (a for a in actions if a["id"] == entry.id)
        for kind, sign, default in (("consumes", -1, "start"), ("produces", 1, "end")):
            for part in action.get(kind, []):
                at_start = part.get("at", default) == "start"
                changes.append((entry.start if at_start else entry.end, sign * part["amount"]))
    changes.sort(key=lambda change: change[0])
    return [sum(amount for _, amount in changes[:k]) for k in range(len(changes) + 1)]


def draw_groups(draw: Draw, entries: Sequence[Entry]) -> list[dict[str, Any]]:
    single = [e for e in entries if sum(o.id == e.id for o in entries) == 1]
    if not single or not draw(st.booleans()):
        return []
    members = single[: draw(st.integers(1, len(single)))]
    return [
        {
            "id": "order",
            "actions": [e.id for e in members],
            "required": draw(st.booleans()),
            "deadline": text(max(e.end for e in members)),
        }
    ]


def damage(draw: Draw, entries: list[Entry]) -> list[Entry]:
    """One random change to a schedule; it need not make it wrong."""
    i = draw(st.integers(0, len(entries) - 1))
    old = entries[i]
    step = draw(st.sampled_from([-1, 1, Fraction(1, 3), Fraction(-1, 3), 3]))
    name = draw(st.sampled_from("xyz"))
    amount = draw(st.integers(1, 2))
    changed = draw(
        st.sampled_from(
            [
                [
                    Entry(
                        old.id,
                        old.start + step,
                        old.end + step,
                        old.resources,
                        old.mode,
                        old.occurrence,
                    )
                ],
                [Entry(old.id, old.start + step, old.end, old.resources, old.mode, old.occurrence)],
                [Entry(old.id, old.start, old.end + step, old.resources, old.mode, old.occurrence)],
                [Entry(old.id, old.start, old.end, {name: amount}, old.mode, old.occurrence)],
                [
                    Entry(
                        old.id,
                        old.start,
                        old.end,
                        {**old.resources, name: 1},
                        old.mode,
                        old.occurrence,
                    )
                ],
                [Entry(old.id, old.start, old.end, old.resources, "slow", old.occurrence)],
                [Entry(old.id, old.start, old.end, old.resources, old.mode, old.occurrence + 1)],
                [Entry("nobody", old.start, old.end, old.resources, old.mode, old.occurrence)],
                [old, old],
                [],
            ]
        )
    )
    return [*entries[:i], *changed, *entries[i + 1 :]]


SLOW = settings(
    max_examples=200, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True
)


# State: few happenings at few instants, so that ranks matter.

STATE = [
    {"id": "p", "initial": False},
    {"id": "q", "values": ["u", "v", "w"], "initial": "u"},
]
VALUES = {"p": [False, True], "q": ["u", "v", "w"]}


COUNTS = st.sampled_from([1, 1, 0, 2])


@st.composite
def facts(draw: Draw, moments: list[str]) -> dict[str, Any]:
    var = draw(st.sampled_from(["p", "p", "q"]))
    value = draw(st.sampled_from(VALUES[var]))
    return {"at": draw(st.sampled_from(moments)), "var": var, "value": value}


@st.composite
def state_cases(draw: Draw, with_levels: bool = False) -> tuple[Task, list[Entry]]:
    actions, entries, nodes = [], [], 0
    latest = draw(st.integers(0, 2))
    for name in "abcd"[: draw(st.integers(1, 4))]:
        start, length = draw(st.integers(0, latest)), draw(st.integers(0, 2))
        duration: Any = length
        if nodes < 3 and draw(st.integers(0, 2)) == 0:
            low = max(0, length - draw(st.integers(0, 1)))
            duration = {"min": low, "max": length + draw(st.integers(0, 1))}
        nodes += 1 + isinstance(duration, dict)
        if nodes > 4:
            break
        conditions = [draw(facts(["start", "all", "end"])) for _ in range(draw(COUNTS))]
        effects = [draw(facts(["start", "end"])) for _ in range(draw(COUNTS))]
        action = {"id": name, "duration": duration, "conditions": conditions, "effects": effects}
        held = {}
        if with_levels and draw(st.booleans()):
            held = {"r": draw(st.integers(1, 2))}
            action["uses"] = [{"resource": "r", "amount": held["r"]}]
        for kind in draw(
            st.sampled_from([[], ["consumes"], ["produces"], ["consumes", "produces"]])
        ):
            if with_levels:
                stock = draw(st.sampled_from(["m", "n"]))
                at = draw(st.sampled_from(["start", "end"]))
                amount = draw(st.integers(1, 2))
                action[kind] = [{"resource": stock, "amount": amount, "at": at}]
        actions.append(action)
        entries.append(Entry(name, start, start + length, held))
    if with_levels and draw(st.booleans()):
        start = draw(st.integers(0, latest))
        effect = {"at": "start", "var": "p", "value": draw(st.booleans())}
        actions.append({"id": f"p at {start}", "duration": 0, "start": start, "effects": [effect]})
        entries.append(Entry(f"p at {start}", start, start))
    precedence = draw_precedence(draw, entries)
    goals = [
        {k: v for k, v in g.items() if k != "at"}
        for g in draw(st.lists(facts(["end"]), max_size=1))
    ]
    document = {"actions": actions, "precedence": precedence, "state": STATE, "goals": goals}
    if with_levels:
        document["resources"] = [
            {"id": "r", "capacity": draw(st.integers(1, 4))},
            {"id": "m", "kind": "reservoir", "initial": 1, "max": draw(st.integers(1, 3))},
            {"id": "n", "kind": "reservoir", "initial": draw(st.integers(0, 2))},
        ]
    task = Task.model_validate(document)
    return task, entries
