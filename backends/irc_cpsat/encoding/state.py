"""State in a CP-SAT model.

Each effect owns its variable from its happening to the next effect on it, so no two of these
intervals overlap; each condition picks one effect (or the initial value) that owns the variable
where it reads. All on the line of moments (time × ranks + rank), where "just before" is strict:
two happenings of one moment must not interfere (docs/semantics.md, rule 6; the encoding is that
of chronicles with supporters, Bit-Monnot, "Constraint-based encoding of temporal planning", 2018).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from irc.problem import Condition
from irc_cpsat.encoding.builder import Builder, Literal

_BEFORE_ALL = -1
"""The moment of the initial values."""


@dataclass(frozen=True)
class _Owner:
    """An effect (or the initial value: no activity) and the moments it owns: [start, end)."""

    activity: int | None
    value: int
    at_end: bool
    start: Any
    end: Any
    literal: Literal | None


def add_state(builder: Builder) -> None:
    """Adds every variable's effects, conditions and goals."""
    if not builder.problem.variables:
        return
    encoder = _StateEncoder(builder)
    for v in range(len(builder.problem.variables)):
        encoder.add_variable(v)


class _StateEncoder:
    """Adds variables one by one; happenings and literals that they share are made once."""

    def __init__(self, builder: Builder) -> None:
        self.builder = builder
        self.model = builder.model
        self.problem = builder.problem
        self.last = (builder.horizon + 1) * builder.rank_count
        self.stretched: dict[int, Literal] = {}
        self.last_end: Any = None
        self.effects: list[list[tuple[int, int, bool]]] = [[] for _ in self.problem.variables]
        self.conditions: list[list[tuple[int, Condition]]] = [[] for _ in self.problem.variables]
        for i, activity in enumerate(self.problem.activities):
            for effect in activity.details.effects:
                self.effects[effect.var].append((i, effect.value, effect.at_end))
            for condition in activity.details.conditions:
                self.conditions[condition.var].append((i, condition))

    def add_variable(self, v: int) -> None:
        """Adds the effects, conditions and goals of one variable."""
        owners = self._owners(v)
        for i, condition in self.conditions[v]:
            self._add_condition(i, condition, owners)
        for var, value in self.problem.goals:
            if var == v and self.problem.variables[v].changes:
                self._add_goal_in_time(value, owners)
            elif var == v:
                self._add_goal(value, owners)

    # --- happenings ---

    def _point(self, i: int, *, at_end: bool) -> Any:
        """A variable for the moment of a happening (intervals take one variable, not two)."""
        if self.problem.activities[i].is_fixed:
            start = self._variable(i, at_end=False)
            if not at_end:
                return start
            return start + self.problem.activities[i].duration_min * self.builder.rank_count
        return self._variable(i, at_end=at_end)

    def _variable(self, i: int, *, at_end: bool) -> Any:
        return self.builder.point(i, at_end=at_end)

    def _one_happening(self, i: int) -> bool | None:
        """Whether start and end are one happening; None where that is open."""
        activity = self.problem.activities[i]
        if activity.duration_min > 0:
            return False
        return True if activity.duration_max == 0 else None

    def _is_stretched(self, i: int) -> Literal:
        """A literal that says that start and end are two happenings."""
        if i not in self.stretched:
            literal = self.model.new_bool_var("")
            start, end = self._point(i, at_end=False), self._point(i, at_end=True)
            self.model.add(end >= start + 1).only_enforce_if(literal)
            self.model.add(end == start).only_enforce_if(~literal)
            self.stretched[i] = literal
        return self.stretched[i]

    # --- effects ---

    def _owners(self, v: int) -> list[_Owner]:
        variable = self.problem.variables[v]
        until = self.model.new_int_var(0, self.last + 1, f"{variable.id} until")
        owners = [_Owner(None, variable.initial, False, _BEFORE_ALL, until, None)]
        intervals = [
            self.model.new_interval_var(_BEFORE_ALL, until - _BEFORE_ALL, until, variable.id)
        ]
        for i, value, at_end in self._distinct_effects(v):
            start = self._point(i, at_end=at_end)
            size = self.model.new_int_var(1, 3 * self.last + 2, "")
            end = self.model.new_int_var(0, 3 * self.last + 2, "")
            literal = self._effect_literal(i, value, at_end, v)
            if literal is None:
                interval = self.model.new_interval_var(start, size, end, variable.id)
            else:
                interval = self.model.new_optional_interval_var(
                    start, size, end, literal, variable.id
                )
            intervals.append(interval)
            owners.append(_Owner(i, value, at_end, start, end, literal))
        for at, value in variable.changes:
            if at <= self.builder.horizon:
                owners.append(self._change_owner(v, at, value, intervals))
        self.model.add_no_overlap(intervals)
        return owners

    def _change_owner(self, v: int, at: int, value: int, intervals: list[Any]) -> _Owner:
        """The owner of a timed change: before all starts of its instant that touch the variable."""
        count = self.builder.rank_count
        first = at * count
        start = self.model.new_int_var(first, first + count - 1, "")
        size = self.model.new_int_var(1, 3 * self.last + 2, "")
        end = self.model.new_int_var(0, 3 * self.last + 2, "")
        name = f"{self.problem.variables[v].id} at {at}"
        intervals.append(self.model.new_interval_var(start, size, end, name))
        touching = {i for i, *_ in self.effects[v]} | {i for i, _ in self.conditions[v]}
        for i in sorted(touching):
            self._start_around(i, first, start)
        return _Owner(None, value, False, start, end, None)

    def _start_around(self, i: int, first: int, change: Any) -> None:
        """An activity starts before the instant of a change, or no earlier than the change."""
        opening = self._point(i, at_end=False)
        early = self.model.new_bool_var("")
        late = self.model.new_bool_var("")
        self.model.add(opening < first).only_enforce_if(early)
        self.model.add(opening >= change).only_enforce_if(late)
        present = self.builder.present[i]
        self.model.add_bool_or([early, late, *([] if present is None else [~present])])

    def _end_of_all(self) -> Any:
        """The moment behind everything that happens at the last end."""
        if self.last_end is None:
            ends: list[Any] = [0]
            for i, present in enumerate(self.builder.present):
                end = self.model.new_int_var(0, self.builder.horizon, "")
                self.builder.enforced(self.model.add(end == self.builder.end(i)), i)
                if present is not None:
                    self.model.add(end == 0).only_enforce_if(~present)
                ends.append(end)
            time = self.model.new_int_var(0, self.builder.horizon, "")
            self.model.add_max_equality(time, ends)
            self.last_end = (time + 1) * self.builder.rank_count
        return self.last_end

    def _add_goal_in_time(self, value: int, owners: Sequence[_Owner]) -> None:
        """A goal on a variable that the world changes: later changes do not count."""
        until = self._end_of_all()
        supporters = []
        for owner in owners:
            if owner.value != value:
                continue
            chosen = self.model.new_bool_var("")
            self.model.add(owner.start < until).only_enforce_if(chosen)
            self.model.add(owner.end >= until).only_enforce_if(chosen)
            if owner.literal is not None:
                self.model.add_implication(chosen, owner.literal)
            supporters.append(chosen)
        self.model.add_exactly_one(supporters)

    def _distinct_effects(self, v: int) -> list[tuple[int, int, bool]]:
        """The effects on a variable; an instant gives a value once, though both its ends do."""
        effects = self.effects[v]
        given = set(effects)
        return [
            (i, value, at_end)
            for i, value, at_end in effects
            if not (at_end and self._one_happening(i) is True and (i, value, False) in given)
        ]

    def _effect_literal(self, i: int, value: int, at_end: bool, v: int) -> Literal | None:
        present = self.builder.present[i]
        repeated = at_end and (i, value, False) in self.effects[v]
        if not repeated or self._one_happening(i) is not None:
            return present
        stretched = self._is_stretched(i)
        return stretched if present is None else self.builder.both(stretched, present)

    # --- conditions ---

    def _add_condition(self, i: int, condition: Condition, owners: Sequence[_Owner]) -> None:
        if condition.at != "all":
            self._add_read(i, condition.value, condition.at == "end", owners, ())
            return
        one = self._one_happening(i)
        if one is True:
            self._add_read(i, condition.value, False, owners, ())
        elif one is False:
            self._add_hold(i, condition.value, owners, ())
        else:
            stretched = self._is_stretched(i)
            self._add_read(i, condition.value, False, owners, (~stretched,))
            self._add_hold(i, condition.value, owners, (stretched,))

    def _add_read(
        self, i: int, value: int, at_end: bool, owners: Sequence[_Owner], when: Sequence[Any]
    ) -> None:
        """The variable has the value just before a happening, and no other change is at it."""
        point = self._point(i, at_end=at_end)
        own = [o for o in owners if o.activity == i]
        for owner, chosen in self._supporters(i, value, owners, when):
            self.model.add(owner.start + 1 <= point).only_enforce_if(chosen)
            self._owned_up_to(i, point, at_end, own, owner, chosen)

    def _owned_up_to(
        self, i: int, point: Any, at_end: bool, own: list[_Owner], owner: _Owner, chosen: Literal
    ) -> None:
        """Until its own change at that happening, or beyond the happening if it makes none."""
        if any(o.at_end == at_end for o in own):
            self.model.add(owner.end >= point).only_enforce_if(chosen)
            return
        one = self._one_happening(i)
        if not own or one is False:
            self.model.add(owner.end >= point + 1).only_enforce_if(chosen)
        elif one is True:
            self.model.add(owner.end >= point).only_enforce_if(chosen)
        else:
            stretched = self._is_stretched(i)
            self.model.add(owner.end >= point + 1).only_enforce_if(chosen, stretched)
            self.model.add(owner.end >= point).only_enforce_if(chosen, ~stretched)

    def _add_hold(self, i: int, value: int, owners: Sequence[_Owner], when: Sequence[Any]) -> None:
        """From just after the start to just before the end; the same value may be given again."""
        start, end = self._point(i, at_end=False), self._point(i, at_end=True)
        alone = sum(o.value == value for o in owners) == 1
        for owner, chosen in self._supporters(i, value, owners, when):
            self.model.add(owner.start <= start).only_enforce_if(chosen)
            last = end if alone else start + 1
            self.model.add(owner.end >= last).only_enforce_if(chosen)
        if alone:
            return
        for other in owners:
            # (Its own effects are at its ends, never between them.)
            ever = other is not owners[0] and other.activity != i
            if ever and other.value != value:
                self._keep_out(i, start, end, other, when)

    def _keep_out(self, i: int, start: Any, end: Any, other: _Owner, when: Sequence[Any]) -> None:
        """Another value is given before the hold opens or after it closes."""
        early = self.model.new_bool_var("")
        late = self.model.new_bool_var("")
        self.model.add(other.start <= start).only_enforce_if(early)
        self.model.add(other.start >= end).only_enforce_if(late)
        escapes: list[Any] = [early, late]
        if other.literal is not None:
            escapes.append(~other.literal)
        present = self.builder.present[i]
        if present is not None:
            escapes.append(~present)
        escapes += [~literal for literal in when]
        self.model.add_bool_or(escapes)

    def _add_goal(self, value: int, owners: Sequence[_Owner]) -> None:
        supporters = []
        for owner in owners:
            if owner.value != value:
                continue
            chosen = self.model.new_bool_var("")
            self.model.add(owner.end >= self.last).only_enforce_if(chosen)
            if owner.literal is not None:
                self.model.add_implication(chosen, owner.literal)
            supporters.append(chosen)
        self.model.add_exactly_one(supporters)

    def _supporters(
        self, i: int, value: int, owners: Sequence[_Owner], when: Sequence[Any]
    ) -> list[tuple[_Owner, Literal]]:
        """One literal for each owner that gives the value; exactly one holds where it is needed."""
        found = []
        for owner in owners:
            if owner.value != value:
                continue
            chosen = self.model.new_bool_var("")
            if owner.literal is not None:
                self.model.add_implication(chosen, owner.literal)
            found.append((owner, chosen))
        unneeded: list[Any] = []
        present = self.builder.present[i]
        if present is not None:
            unneeded.append(~present)
        unneeded += [~literal for literal in when]
        literals: list[Any] = [chosen for _, chosen in found]
        if len(unneeded) < 2:
            self.model.add_exactly_one([*literals, *unneeded])
        else:
            self.model.add_bool_or([*literals, *unneeded])
            self.model.add_at_most_one(literals)
        return found
