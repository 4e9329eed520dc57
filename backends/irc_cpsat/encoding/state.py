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
from typing import Any, NamedTuple

from irc.problem import Condition, Effect, Protected
from irc_cpsat.encoding.builder import Builder, Literal
from irc_cpsat.encoding.happenings import Happenings

_BEFORE_ALL = -1
"""The moment of the initial values."""


@dataclass(frozen=True)
class _Owner:
    """An effect (or the initial value: no activity) and the moments it owns: [start, end).

    `mode`: the mode of its activity that has the effect; None: all have it."""

    activity: int | None
    value: int
    at_end: bool
    start: Any
    end: Any
    literal: Literal | None
    mode: int | None = None


class _Effect(NamedTuple):
    """An effect on a variable; `mode`: the mode that has it, None: all have it."""

    activity: int
    value: int
    at_end: bool
    mode: int | None


class _Need(NamedTuple):
    """A condition of an activity in a mode (None: in all), and literals under which it binds."""

    activity: int
    value: int
    mode: int | None = None
    when: tuple[Any, ...] = ()


def add_state(builder: Builder, happenings: Happenings) -> None:
    """Adds every variable's effects, conditions and goals."""
    if not builder.problem.variables:
        return
    encoder = _StateEncoder(builder, happenings)
    for v in range(len(builder.problem.variables)):
        encoder.add_variable(v)


class _StateEncoder:
    """Adds variables one by one; happenings and literals that they share are made once."""

    def __init__(self, builder: Builder, happenings: Happenings) -> None:
        self.builder, self.happenings = builder, happenings
        self.model = builder.model
        self.problem = builder.problem
        self.last = (builder.horizon + 1) * builder.rank_count
        self.effects: list[list[_Effect]] = [[] for _ in self.problem.variables]
        self.conditions: list[list[tuple[_Need, str]]] = [[] for _ in self.problem.variables]
        for i, activity in enumerate(self.problem.activities):
            details = activity.details
            self._collect(i, None, details.effects, details.conditions)
            for m, mode in enumerate(details.modes):
                self._collect(i, m, mode.effects, mode.conditions)

    def _collect(
        self,
        i: int,
        mode: int | None,
        effects: Sequence[Effect],
        conditions: Sequence[Condition],
    ) -> None:
        for var, value, at_end in effects:
            self.effects[var].append(_Effect(i, value, at_end, mode))
        for var, value, at in conditions:
            self.conditions[var].append((_Need(i, value, mode), at))

    def add_variable(self, v: int) -> None:
        """Adds the effects, conditions and goals of one variable."""
        owners = self._owners(v)
        for need, at in self.conditions[v]:
            self.builder.check_time()
            self._add_condition(need, at, owners)
        self._add_protected(v, owners)
        for var, value in self.problem.goals:
            if var == v and self.problem.variables[v].changes:
                self._add_goal_in_time(value, owners)
            elif var == v:
                self._add_goal(value, owners)

    # --- effects ---

    def _owners(self, v: int) -> list[_Owner]:
        variable = self.problem.variables[v]
        until = self.model.new_int_var(0, self.last + 1, f"{variable.id} until")
        owners = [_Owner(None, variable.initial, False, _BEFORE_ALL, until, None)]
        intervals = [
            self.model.new_interval_var(_BEFORE_ALL, until - _BEFORE_ALL, until, variable.id)
        ]
        for effect in self._distinct_effects(v):
            i, value, at_end, mode = effect
            start = self.happenings.point(i, at_end=at_end)
            size = self.model.new_int_var(1, 3 * self.last + 2, "")
            end = self.model.new_int_var(0, 3 * self.last + 2, "")
            literal = self._effect_literal(effect, v)
            if literal is None:
                interval = self.model.new_interval_var(start, size, end, variable.id)
            else:
                interval = self.model.new_optional_interval_var(
                    start, size, end, literal, variable.id
                )
            intervals.append(interval)
            owners.append(_Owner(i, value, at_end, start, end, literal, mode))
        for at, value in variable.changes:
            if at <= self.builder.horizon:
                owners.append(self._change_owner(v, at, value, intervals))
        self.model.add_no_overlap(intervals)
        return owners

    def _change_owner(self, v: int, at: int, value: int, intervals: list[Any]) -> _Owner:
        """The owner of a timed change: before all starts of its instant that touch the variable."""
        start = self.happenings.change(at)
        size = self.model.new_int_var(1, 3 * self.last + 2, "")
        end = self.model.new_int_var(0, 3 * self.last + 2, "")
        name = f"{self.problem.variables[v].id} at {at}"
        intervals.append(self.model.new_interval_var(start, size, end, name))
        touching = {(e.activity, e.mode) for e in self.effects[v]}
        touching |= {(need.activity, need.mode) for need, _ in self.conditions[v]}
        for i, mode in sorted(touching, key=lambda t: (t[0], -1 if t[1] is None else t[1])):
            if mode is None or (i, None) not in touching:
                literal = self.happenings.carried_out(i, mode)
                self.happenings.start_around(i, () if literal is None else (literal,), at, start)
        return _Owner(None, value, False, start, end, None)

    def _add_goal_in_time(self, value: int, owners: Sequence[_Owner]) -> None:
        """A goal on a variable that the world changes: later changes do not count."""
        until = self.happenings.end_of_all()
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

    def _distinct_effects(self, v: int) -> list[_Effect]:
        """The effects on a variable; an instant gives a value once, though both its ends do."""
        given = set(self.effects[v])

        def is_repeated(effect: _Effect) -> bool:
            if effect.mode is not None and effect._replace(mode=None) in given:
                return True
            if not effect.at_end or self.happenings.one_happening(effect.activity) is not True:
                return False
            first = effect._replace(at_end=False)
            return first in given or first._replace(mode=None) in given

        return [effect for effect in self.effects[v] if not is_repeated(effect)]

    def _effect_literal(self, effect: _Effect, v: int) -> Literal | None:
        """A literal that says that an effect happens, and not as one with the start's."""
        i, value, at_end, mode = effect
        literal = self.happenings.carried_out(i, mode)
        one = self.happenings.one_happening(i)
        if not at_end or one is False:
            return literal
        for other in self.effects[v]:
            if (other.activity, other.value, other.at_end) != (i, value, False):
                continue
            if other.mode is None or other.mode == mode:
                own: Any = self.happenings.is_stretched(i)
            elif mode is None:
                own = ~self.builder.modes[i][other.mode]
                if one is None:
                    own = self._either(own, self.happenings.is_stretched(i))
            else:
                continue
            literal = own if literal is None else self.builder.both(own, literal)
        return literal

    def _either(self, a: Any, b: Any) -> Literal:
        """A literal that is true where one of two is."""
        either = self.model.new_bool_var("")
        self.model.add_bool_or(a, b).only_enforce_if(either)
        self.model.add_bool_and(~a, ~b).only_enforce_if(~either)
        return either

    # --- conditions ---

    def _add_condition(self, need: _Need, at: str, owners: Sequence[_Owner]) -> None:
        if at != "all":
            self._add_read(need, at == "end", owners)
            return
        one = self.happenings.one_happening(need.activity)
        if one is True:
            self._add_read(need, False, owners)
        elif one is False:
            self._add_hold(need, owners)
        else:
            stretched = self.happenings.is_stretched(need.activity)
            self._add_read(need._replace(when=(~stretched,)), False, owners)
            self._add_hold(need._replace(when=(stretched,)), owners)

    def _add_read(self, need: _Need, at_end: bool, owners: Sequence[_Owner]) -> None:
        """The variable has the value just before a happening, and no other change is at it."""
        point = self.happenings.point(need.activity, at_end=at_end)
        changing = self._own_changes(need, at_end, owners)
        for owner, chosen in self._supporters(need, owners):
            self.model.add(owner.start + 1 <= point).only_enforce_if(chosen)
            self._owned_up_to(point, changing, owner, chosen)

    def _owned_up_to(
        self, point: Any, changing: list[Any] | None, owner: _Owner, chosen: Literal
    ) -> None:
        """Until the reader's own change at that happening, or beyond it if it makes none."""
        if changing is not None:
            beyond = self.model.add(owner.end >= point + 1)
            beyond.only_enforce_if(chosen, *(~literal for literal in changing))
        if changing is None or len(changing) > 1:
            self.model.add(owner.end >= point).only_enforce_if(chosen)
        elif changing:
            self.model.add(owner.end >= point).only_enforce_if(chosen, *changing)

    def _own_changes(self, need: _Need, at_end: bool, owners: Sequence[_Owner]) -> list[Any] | None:
        """Literals of which one is true where the reader itself changes the variable as it reads.

        None where it always does.
        """
        i = need.activity
        one = self.happenings.one_happening(i)
        found: list[Any] = []
        for own in owners:
            if own.activity != i or (one is False and own.at_end != at_end):
                continue
            always = own.mode is None or own.mode == need.mode
            literals: list[Any] = []
            if not always and own.mode is not None:
                literals.append(self.builder.modes[i][own.mode])
            if own.at_end != at_end and one is None:
                literals.append(~self.happenings.is_stretched(i))
            if not literals:
                return None
            found.append(literals[0] if len(literals) == 1 else self.builder.both(*literals))
        return found

    def _add_hold(self, need: _Need, owners: Sequence[_Owner]) -> None:
        """From just after the start to just before the end; the same value may be given again."""
        i, value = need.activity, need.value
        start, end = self.happenings.point(i, at_end=False), self.happenings.point(i, at_end=True)
        alone = sum(o.value == value for o in owners) == 1
        for owner, chosen in self._supporters(need, owners):
            self.model.add(owner.start <= start).only_enforce_if(chosen)
            last = end if alone else start + 1
            self.model.add(owner.end >= last).only_enforce_if(chosen)
        if alone:
            return
        for other in owners:
            # (Its own effects are at its ends, never between them.)
            ever = other is not owners[0] and other.activity != i
            if ever and other.value != value:
                self._keep_out(need, start, end, other)

    def _keep_out(self, need: _Need, start: Any, end: Any, other: _Owner) -> None:
        """Another value is given before the hold opens or after it closes."""
        early = self.model.new_bool_var("")
        late = self.model.new_bool_var("")
        self.model.add(other.start <= start).only_enforce_if(early)
        self.model.add(other.start >= end).only_enforce_if(late)
        escapes: list[Any] = [early, late]
        if other.literal is not None:
            escapes.append(~other.literal)
        self.model.add_bool_or([*escapes, *self._unneeded(need)])

    def _unneeded(self, need: _Need) -> list[Any]:
        """Literals of which one is true where a condition does not bind."""
        present = self.happenings.carried_out(need.activity, need.mode)
        return [*([] if present is None else [~present]), *(~literal for literal in need.when)]

    def _add_protected(self, v: int, owners: Sequence[_Owner]) -> None:
        """Orders what takes a protected value away behind those that need it throughout.

        Or the variable has another value just before.
        """
        for change in owners:
            if change.activity is None:
                continue
            for p in self.problem.activities[change.activity].details.protects:
                if p.var == v and p.value != change.value:
                    self._take_no_value_away(p, change, owners)

    def _take_no_value_away(
        self, protected: Protected, change: _Owner, owners: Sequence[_Owner]
    ) -> None:
        needs = protected.activity
        after = self.model.new_bool_var("")
        closing = self.happenings.point(needs, at_end=True)
        self.model.add(change.start >= closing).only_enforce_if(after)
        escapes: list[Any] = [after]
        if change.literal is not None:
            escapes.append(~change.literal)
        for other in owners:
            if other.value == protected.value or other is change:
                continue
            instead = self.model.new_bool_var("")
            self.model.add(other.start + 1 <= change.start).only_enforce_if(instead)
            self.model.add(other.end >= change.start).only_enforce_if(instead)
            if other.literal is not None:
                self.model.add_implication(instead, other.literal)
            escapes.append(instead)
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

    def _supporters(self, need: _Need, owners: Sequence[_Owner]) -> list[tuple[_Owner, Literal]]:
        """One literal for each owner that gives the value; exactly one holds where it is needed."""
        found = []
        for owner in owners:
            if owner.value != need.value:
                continue
            chosen = self.model.new_bool_var("")
            if owner.literal is not None:
                self.model.add_implication(chosen, owner.literal)
            found.append((owner, chosen))
        unneeded = self._unneeded(need)
        literals: list[Any] = [chosen for _, chosen in found]
        if len(unneeded) < 2:
            self.model.add_exactly_one([*literals, *unneeded])
        else:
            self.model.add_bool_or([*literals, *unneeded])
            self.model.add_at_most_one(literals)
        return found
