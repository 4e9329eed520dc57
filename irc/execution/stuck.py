"""Finds actions that cannot go on: their resources, stock or conditions are gone for good.

Everything here is certain: what it finds cannot be carried out as the task now is. It says nothing
of times that are merely too short for all that is to be done.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from irc.diagnostics import Code, Diagnostic
from irc.diagnostics.listing import and_more
from irc.execution.freeze import FrozenProblem
from irc.model.state_values import value_text
from irc.problem import IMPOSSIBLE_DEADLINE, Activity, Condition, Problem, Renewable

SHOWN = 50
"""At most this many are named with their reasons, and as many more by name."""

Fact = tuple[int, int]
"""A state variable and a value, as indexes."""


@dataclass(frozen=True)
class Stuck:
    """Required actions that cannot go on (id: why), and goals on state that cannot be reached.

    `others` are optional actions that cannot either, as what they wait for cannot.
    """

    actions: dict[str, str] = field(default_factory=dict)
    others: frozenset[str] = frozenset()
    goals: tuple[tuple[str, bool | str], ...] = ()

    def __bool__(self) -> bool:
        """Whether anything that is wanted cannot go on."""
        return bool(self.actions or self.goals)


def in_words(stuck: Stuck, stopped: Sequence[str] = ()) -> tuple[Diagnostic, ...]:
    """The actions and goals that cannot go on, as diagnostics.

    `stopped` are cancelled actions that have not been done again.
    """
    reasons = list(stuck.actions.items())
    found = [
        Diagnostic(Code.NO_CONTINUATION, why, hint=f"{name!r} is left out until that changes")
        for name, why in reasons[:SHOWN]
    ]
    if len(reasons) > SHOWN:
        more = [repr(name) for name, _ in reasons[SHOWN : 2 * SHOWN]]
        names = and_more(more, len(reasons) - SHOWN)
        what = f"neither can these go on: {names}"
        hint = "they are left out until that changes"
        found.append(Diagnostic(Code.NO_CONTINUATION, what, hint=hint))
    for var, value in stuck.goals:
        what = f"the goal {var!r} = {value_text(value)} cannot be reached any more"
        hint = "it is left out; an action that brings it about, or other goals, would help"
        if stopped:
            names = and_more([repr(name) for name in stopped[:5]], len(stopped))
            hint += f"; `retry_action` does again what was cancelled: {names}"
        found.append(Diagnostic(Code.NO_CONTINUATION, what, hint=hint))
    return tuple(found)


def what_is_stuck(frozen: FrozenProblem, before: Problem) -> Stuck:
    """The actions and goals of a frozen problem that cannot be carried out or reached any more.

    `before` is the problem before it was frozen: its capacities have no room lent to the history.
    """
    return _Search(frozen, before).all()


@dataclass
class _Search:
    frozen: FrozenProblem
    before: Problem
    why: dict[int, str] = field(default_factory=dict)

    @property
    def problem(self) -> Problem:
        return self.frozen.problem

    def all(self) -> Stuck:
        """Goes on until nothing more is found: each that is stuck takes others with it."""
        for i in self.open:
            self._add(i, self._without_resource(self.problem.activities[i]))
        while True:
            found = len(self.why)
            self._wait_for_each_other()
            if self.before.reservoirs or self.before.has_state:
                self._run_dry()
            if len(self.why) == found:
                break
        names = {self.problem.activities[i].id: why for i, why in self.why.items()}
        wanted = {self.problem.activities[i].id for i in self.why if i in self.required}
        return Stuck(
            {name: why for name, why in names.items() if name in wanted},
            frozenset(names) - wanted,
            tuple(self._lost_goals()),
        )

    def _add(self, i: int, why: str | None) -> None:
        if why is not None:
            self.why.setdefault(i, why)

    @cached_property
    def open(self) -> list[int]:
        """The activities that have not begun and are not over."""
        return [
            i
            for i, a in enumerate(self.problem.activities)
            if i not in self.frozen.executed and a.deadline != IMPOSSIBLE_DEADLINE
        ]

    @cached_property
    def required(self) -> set[int]:
        """The activities that must happen, whatever is chosen."""
        problem = self.problem
        chosen = {i for g in problem.groups if not g.required for i in g.members}
        must = {i for g in problem.groups if g.required for i in g.members} | {*problem.required}
        for i, activity in enumerate(problem.activities):
            repeats = activity.details.repeats
            optional = activity.details.optional or (repeats is not None and not repeats[0])
            if not optional and i not in chosen:
                must.add(i)
        return must

    # --- resources ---

    def _without_resource(self, activity: Activity) -> str | None:
        """Why an activity cannot get its resources in any mode; None where it may."""
        modes = range(len(activity.details.modes)) if activity.details.modes else (None,)
        reasons = [self._in_mode(activity, mode) for mode in modes]
        return reasons[0] if all(reason is not None for reason in reasons) else None

    def _in_mode(self, activity: Activity, mode: int | None) -> str | None:
        length = activity.duration_min
        if mode is not None:
            length = activity.details.modes[mode].duration_min
        if activity.details.work:
            length = min(1, length)  # Any open time is good to begin or to go on with.
        begin = max(activity.release, self.frozen.now)
        for u in activity.uses_in(mode) if length else ():
            use = activity.uses[u]
            its = [self.before.resources[r] for r in use.alternatives]
            if any(_has_time(r, use.amount, length, begin) for r in its):
                continue
            names = " or ".join(repr(r.id) for r in its)
            most = max(r.greatest_capacity(begin) for r in its)
            needs = f"{activity.id!r} needs {use.amount} of {names}"
            if most < use.amount:
                return f"{needs}, which has at most {most} from now on"
            return f"{needs} for {self.problem.time_text(length)}, which has no such time left"
        return None

    # --- what waits for what ---

    def _wait_for_each_other(self) -> None:
        """Adds activities that wait for stuck ones, or must be followed by them in time."""
        again = True
        while again:
            again = False
            for arc in self.problem.arcs:
                for i, j, binds in (
                    (arc.before, arc.after, True),
                    (arc.after, arc.before, arc.max_lag is not None),
                ):
                    stuck = i in self.why and i in self.required
                    if binds and stuck and j in self._open_set and j not in self.why:
                        first, second = (self.problem.activities[k].id for k in (i, j))
                        self.why[j] = f"{second!r} waits for {first!r}, which cannot go on"
                        again = True

    @cached_property
    def _open_set(self) -> frozenset[int]:
        return frozenset(self.open)

    # --- stock and state ---

    def _run_dry(self) -> None:
        """Activities that ask for more stock, or for a value, than there can ever be."""
        levels = self._greatest_levels() if self.before.reservoirs else []
        values = self._reachable() if self.before.variables else set()
        for i in self.open:
            if i in self.why:
                continue
            activity = self.problem.activities[i]
            details = activity.details
            taken: Counter[int] = Counter()
            for change in details.stock:
                if change.reservoir < len(levels) and (not change.at_end or change.amount < 0):
                    taken[change.reservoir] -= change.amount
            for r, amount in taken.items():
                if amount > levels[r]:
                    name = self.before.reservoirs[r].id
                    self._add(
                        i,
                        f"{activity.id!r} needs {amount} of {name!r}, of which there are at most "
                        f"{max(0, levels[r])}",
                    )
            for condition in details.conditions:
                if (condition.var, condition.value) not in values:
                    self._add(i, self._not_reached(activity, condition))

    def _not_reached(self, activity: Activity, condition: Condition) -> str:
        variable = self.problem.variables[condition.var]
        value = value_text(variable.values[condition.value])
        return f"{activity.id!r} needs {variable.id!r} = {value}, which nothing brings about"

    def _greatest_levels(self) -> list[int]:
        """For each reservoir what it has if nothing more is taken and all that can be is put in."""
        levels = [
            max(one.initial, lent.initial) - one.least
            for one, lent in zip(self.before.reservoirs, self.problem.reservoirs, strict=False)
        ]
        endless: set[int] = set()
        for i, activity in enumerate(self.problem.activities):
            past = self.frozen.executed.get(i)
            if past is None and i not in self._open_set:
                continue
            for change in activity.details.all_stock:
                if change.reservoir >= len(levels):
                    continue  # What is lent to the history, which nothing else takes.
                if past is not None:
                    happened = not change.at_end or not past.running
                    if happened or change.amount > 0:
                        levels[change.reservoir] += change.amount
                elif change.amount > 0 and i not in self.why:
                    most = activity.details.repeats and activity.details.repeats[1]
                    levels[change.reservoir] += change.amount * (most or 1)
                    if activity.details.repeats is not None and most is None:
                        endless.add(change.reservoir)
        return [_ENDLESS if r in endless else level for r, level in enumerate(levels)]

    def _reachable(self) -> set[Fact]:
        """The values that variables have now, or that something may still give them.

        What gives a value must first be able to happen itself: no two activities wait for each
        other. Timed changes give theirs. (Values never get lost here, which makes more of them
        seem to be reached.)
        """
        values = set(self._now())
        for v, variable in enumerate(self.problem.variables):
            values |= {(v, change.value) for change in variable.changes}
        for i, activity in enumerate(self.problem.activities):
            if self._runs(i):
                values |= {(e.var, e.value) for e in activity.details.effects if e.at_end}
        waiting = [(i, at_end) for i in self.open if i not in self.why for at_end in (False, True)]
        while True:
            left = [(i, at_end) for i, at_end in waiting if not self._happens(i, at_end, values)]
            if len(left) == len(waiting):
                return values
            waiting = left

    def _happens(self, i: int, at_end: bool, values: set[Fact]) -> bool:
        """Whether an open activity can start, or end, with these values; then adds its own."""
        details = self.problem.activities[i].details
        needed = (c for c in details.conditions if at_end or c.at == "start")
        if not all((c.var, c.value) in values for c in needed):
            return False
        values |= {(e.var, e.value) for e in details.all_effects if e.at_end == at_end}
        return True

    def _runs(self, i: int) -> bool:
        past = self.frozen.executed.get(i)
        return past is not None and past.running

    def _now(self) -> Iterator[Fact]:
        """The values that variables may have now: in doubt about an order, several."""
        writes: dict[int, tuple[int, set[int]]] = {}
        for i, past in self.frozen.executed.items():
            for effect in self.problem.activities[i].details.effects:
                if effect.at_end and past.running:
                    continue
                time = past.end if effect.at_end else past.start
                last, values = writes.get(effect.var, (-1, set()))
                if time > last:
                    writes[effect.var] = time, {effect.value}
                elif time == last:
                    values.add(effect.value)
        for v, variable in enumerate(self.problem.variables):
            for value in writes.get(v, (0, {variable.initial}))[1]:
                yield v, value

    def _lost_goals(self) -> Iterator[tuple[str, bool | str]]:
        if not self.problem.goals:
            return
        values = self._reachable()
        for v, value in self.problem.goals:
            if (v, value) not in values:
                variable = self.problem.variables[v]
                wanted = variable.values[value]
                if wanted is not None:
                    yield variable.id, wanted


_ENDLESS = 1 << 62


def _has_time(resource: Renewable, amount: int, length: int, begin: int) -> bool:
    """Whether a resource has an amount for a length of time, from `begin` on."""
    return any(
        end is None or (end > begin and end - max(start, begin) >= length)
        for start, end in resource.open_times(amount)
    )
