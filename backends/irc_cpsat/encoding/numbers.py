"""Number variables in a CP-SAT model: sums over what comes before, never a list of levels.

All happenings that change or read a number have moments of their own (docs/semantics.md, rule 6.3).
For a change w and a happening h one literal says that w comes before h, so that the level just
before h is a linear sum over these literals: `initial + Σ amount × literal`. Where effects also
*set* the level, each of them owns the number until the next one, as in `irc_cpsat.encoding.state`,
and the level before h is that of its owner s, plus what was added before h, less what was added
before s. So the size of the model is quadratic in the number of happenings, whatever the levels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from irc.problem import Details, NumberCondition, NumberVariable
from irc_cpsat.encoding.builder import Builder, Literal
from irc_cpsat.encoding.happenings import Happenings

Point = tuple[int, bool]
"""The start or the end of an activity. A timed change is (-1 - its number, False)."""

_END = (1 << 60, True)
"""The key of the moment behind everything."""

_BOTH = 2
"""The number of ends of an activity."""

_BEFORE_ALL = -1
"""The moment of the initial level."""

_FAR = 2**62
"""Beyond all levels (see `irc_cpsat.encoding.overflow`)."""


class _Write(NamedTuple):
    """A change: its happening, and the literals under which it takes place."""

    point: Point
    amount: int
    sets: bool
    when: tuple[Literal, ...]
    mode: int | None = None
    """The mode in which its activity makes it; None: in all."""


@dataclass(frozen=True)
class _Owner:
    """A write that sets the level, or the initial level, and the moments [start, end) it owns."""

    write: _Write | None
    level: int
    start: Any
    end: Any
    added: Any
    """The amount that was added before it."""


@dataclass
class _Touches:
    """The happenings that read and change one number."""

    writes: list[_Write] = field(default_factory=list)
    reads: list[tuple[int, NumberCondition, tuple[Literal, ...]]] = field(default_factory=list)
    strict: set[Point] = field(default_factory=set)
    """The happenings that read or change it in all modes, and so have moments of their own."""


def add_numbers(builder: Builder, happenings: Happenings) -> None:
    """Adds every number's changes, bounds, conditions and goals."""
    if not builder.problem.numbers:
        return
    order = _Order(builder, happenings)
    for k, number in enumerate(builder.problem.numbers):
        _NumberEncoder(builder, happenings, order, k, number).add()


class _Order:
    """Literals for the order of two happenings; each is made once, whatever number asks for it.

    They are meaningful only where both happenings take place.
    """

    def __init__(self, builder: Builder, happenings: Happenings) -> None:
        self.model, self.happenings = builder.model, happenings
        self.moments: dict[Point, Any] = {}
        self.known: dict[tuple[str, Point, Point], Any] = {}

    def moment(self, point: Point) -> Any:
        """The moment of a happening."""
        if point not in self.moments:
            i, at_end = point
            self.moments[point] = self.happenings.point(i, at_end=at_end)
        return self.moments[point]

    def before(self, a: Point, b: Point) -> Any:
        """Whether a is before b; if not, it is after b."""
        own = self._own(a, b)
        if own is not None:
            return own
        if ("before", b, a) in self.known:
            return ~self.known["before", b, a]
        return self._literal("before", a, b, 1, 1)

    def no_later(self, a: Point, b: Point) -> Any:
        """Whether a is not after b: with it, or before."""
        own = self._own(a, b)
        return own if own is not None else self._literal("no later", a, b, 0, 1)

    def earlier(self, a: Point, b: Point) -> Any:
        """Whether a is before b; if not, it is with it or after."""
        own = self._own(a, b)
        return own if own is not None else self._literal("earlier", a, b, 1, 0)

    def _own(self, a: Point, b: Point) -> Any:
        """The order of happenings of one activity; None for those of two."""
        if a[0] != b[0]:
            return None
        if a[1] or not b[1]:
            return False
        one = self.happenings.one_happening(a[0])
        return self.happenings.is_stretched(a[0]) if one is None else not one

    def _literal(self, kind: str, a: Point, b: Point, gap: int, back: int) -> Any:
        key = kind, a, b
        if key not in self.known:
            literal = self.model.new_bool_var("")
            self.model.add(self.moment(a) + gap <= self.moment(b)).only_enforce_if(literal)
            self.model.add(self.moment(b) + back <= self.moment(a)).only_enforce_if(~literal)
            self.known[key] = literal
        return self.known[key]


class _NumberEncoder:
    def __init__(
        self,
        builder: Builder,
        happenings: Happenings,
        order: _Order,
        k: int,
        number: NumberVariable,
    ) -> None:
        self.builder, self.happenings, self.order = builder, happenings, order
        self.model, self.problem = builder.model, builder.problem
        self.k, self.number = k, number
        self.last = (builder.horizon + 1) * builder.rank_count
        self.touches = _Touches()
        self.owners: list[_Owner] = []
        self.levels: dict[tuple[str, Point, tuple[int, ...]], Any] = {}

    def add(self) -> None:
        """Adds all about the number."""
        self._read_activities()
        self._add_changes()
        self._keep_apart()
        self._add_owners()
        for write in self.touches.writes:
            self._keep_bounds(write)
            self._add_protected(write)
        for i, condition, when in self.touches.reads:
            self._add_condition(i, condition, when)
        for goal in self.problem.number_goals:
            if goal.number == self.k:
                level = self._level(_END, "before")
                self._within(level, goal.least, goal.greatest, ())

    # --- what touches the number ---

    def _read_activities(self) -> None:
        for i, activity in enumerate(self.problem.activities):
            by_mode = any(m.number_conditions or m.number_effects for m in activity.details.modes)
            modes = range(len(activity.details.modes)) if by_mode else (None,)
            strict: list[set[Point]] = []
            for mode in modes:
                literal = self.happenings.carried_out(i, mode)
                when = () if literal is None else (literal,)
                details = activity.details.in_mode(mode)
                strict.append(self._read_details(i, mode, details, when))
            self.touches.strict |= set.intersection(*strict)

    def _read_details(
        self, i: int, mode: int | None, details: Details, when: tuple[Literal, ...]
    ) -> set[Point]:
        """The conditions and effects of an activity in a mode; the happenings that have them."""
        one = self.happenings.one_happening(i)
        found: set[Point] = set()
        for condition in details.number_conditions:
            if condition.number == self.k:
                self.touches.reads.append((i, condition, when))
                if condition.at != "all" or one is True:
                    found.add((i, condition.at == "end" and one is not True))
        own = [e for e in details.number_effects if e.number == self.k]
        for at_end in (False, True):
            here = [e for e in own if (e.at_end and one is not True) == at_end]
            levels = {e.amount for e in here if e.sets}
            added = [e.amount for e in here if not e.sets]
            if len(levels) > 1 or (levels and added):
                self.model.add_bool_or([~literal for literal in when])  # Two levels at once.
                return found
            if here:
                amount, sets = (levels.pop(), True) if levels else (sum(added), False)
                self.touches.writes.append(_Write((i, at_end), amount, sets, when, mode))
                found.add((i, at_end))
        if one is None:
            self._join(i, mode)
        return found

    def _join(self, i: int, mode: int | None) -> None:
        """Two changes by an activity whose start and end may be one happening."""
        own = [w for w in self.touches.writes if w.point[0] == i and w.mode == mode]
        if len(own) < _BOTH:
            return
        first, second = own
        if not first.sets and not second.sets:
            return
        stretched = self.happenings.is_stretched(i)
        if (first.amount, first.sets) == (second.amount, second.sets):
            # Given twice at one happening, a level is given once.
            place = self.touches.writes.index(second)
            self.touches.writes[place] = second._replace(when=(*second.when, stretched))
        else:
            self.model.add_bool_or([stretched, *(~literal for literal in first.when)])

    def _add_changes(self) -> None:
        """The timed changes, each with a moment of its own."""
        touching = {(w.point[0], w.when) for w in self.touches.writes}
        touching |= {(i, when) for i, _, when in self.touches.reads}
        for at, level in self.number.changes:
            if at <= self.builder.horizon:
                name = -1 - sum(point[0] < 0 for point in self.order.moments)
                moment = self.order.moments[name, False] = self.happenings.change(at)
                for i, when in sorted(touching, key=lambda t: (t[0], [x.index for x in t[1]])):
                    self.happenings.start_around(i, when, at, moment)
                self.touches.writes.append(_Write((name, False), level, True, ()))
                self.touches.strict.add((name, False))

    def _keep_apart(self) -> None:
        """No two changes share a moment: among those that nothing else compares, this says it."""
        if len(self.touches.writes) < 2:
            return
        intervals = []
        for write in self.touches.writes:
            moment, literal = self.order.moment(write.point), self._when(write)
            if write.point[1] and self._joint(write) is not None:
                # (It may be one happening with the start.)
                literal = self._both(literal, self.happenings.is_stretched(write.point[0]))
            if literal is True:
                intervals.append(self.model.new_fixed_size_interval_var(moment, 1, ""))
            else:
                intervals.append(
                    self.model.new_optional_fixed_size_interval_var(moment, 1, literal, "")
                )
        self.model.add_no_overlap(intervals)

    def _joint(self, write: _Write) -> _Write | None:
        """The change at the other end of its activity, where both may be one happening."""
        i, at_end = write.point
        if i < 0 or self.happenings.one_happening(i) is not None:
            return None
        other = (i, not at_end)
        writes = self.touches.writes
        return next((w for w in writes if (w.point, w.mode) == (other, write.mode)), None)

    # --- literals ---

    def _when(self, write: _Write) -> Any:
        """The literal under which a write takes place, or True."""
        found: Any = True
        for literal in write.when:
            found = self._both(found, literal)
        return found

    def _both(self, a: Any, b: Any) -> Any:
        """A literal, or a constant, that is true where both are."""
        if isinstance(a, bool):
            return b if a else False
        if isinstance(b, bool):
            return a if b else False
        return a if a.index == b.index else self.builder.both(a, b)

    def _within(
        self, level: Any, least: int | None, greatest: int | None, when: Sequence[Any]
    ) -> None:
        """Keeps a level within limits where all of some literals (or constants) are true."""
        if any(literal is False for literal in when) or (least is None and greatest is None):
            return
        low = -_FAR if least is None else least
        high = _FAR if greatest is None else greatest
        literals = [literal for literal in when if literal is not True]
        if isinstance(level, int):
            if not low <= level <= high:
                self.model.add_bool_or([~literal for literal in literals])
            return
        constraint = self.model.add_linear_constraint(level, low, high)
        if literals:
            constraint.only_enforce_if(literals)

    # --- levels ---

    def _add_owners(self) -> None:
        """The owners of the level, where effects or timed changes set it."""
        sets = [w for w in self.touches.writes if w.sets]
        if not sets:
            return
        until = self.model.new_int_var(0, self.last + 1, "")
        self.owners = [_Owner(None, self.number.initial, _BEFORE_ALL, until, 0)]
        size = until - _BEFORE_ALL
        intervals = [self.model.new_interval_var(_BEFORE_ALL, size, until, self.number.id)]
        for write in sets:
            start = self.order.moment(write.point)
            size = self.model.new_int_var(1, 3 * self.last + 2, "")
            end = self.model.new_int_var(0, 3 * self.last + 2, "")
            literal = self._when(write)
            if literal is True:
                interval = self.model.new_interval_var(start, size, end, self.number.id)
            else:
                interval = self.model.new_optional_interval_var(
                    start, size, end, literal, self.number.id
                )
            intervals.append(interval)
            added = self._variable(self._added(write.point, "before"))
            self.owners.append(_Owner(write, write.amount, start, end, added))
        self.model.add_no_overlap(intervals)

    def _variable(self, expression: Any) -> Any:
        if isinstance(expression, int):
            return expression
        reach = self._reach()
        variable = self.model.new_int_var(-reach, reach, "")
        self.model.add(variable == expression)
        return variable

    def _reach(self) -> int:
        """A number that no level is beyond."""
        return abs(self.number.initial) + sum(abs(w.amount) for w in self.touches.writes)

    def _added(self, point: Point, kind: str) -> Any:
        """The amount that is added before a happening, or (kind "after") until just after it."""
        terms = []
        for write in self.touches.writes:
            if not write.sets and write.amount:
                counted = self._counts(write, point, kind)
                if counted is not False:
                    terms.append(write.amount * (1 if counted is True else counted))
        return sum(terms)

    def _counts(self, write: _Write, point: Point, kind: str) -> Any:
        """Whether a change takes place before a happening, or (kind "after") no later."""
        if point == _END:
            return self._when(write)
        if write.point == point:
            return self._when(write) if kind == "after" else False
        if {point, write.point} <= self.touches.strict:
            order = self.order.before(write.point, point)
        elif kind == "after":
            order = self.order.no_later(write.point, point)
        else:
            order = self.order.earlier(write.point, point)
        return self._both(order, self._when(write))

    def _level(self, point: Point, kind: str, needed: Sequence[Any] = ()) -> Any:
        """The level just before a happening, or (kind "after") just after it.

        Where effects set it, it is known only if all the `needed` literals are true.
        """
        # (Only where its level is set does it matter under which literals it is needed.)
        whose = tuple(x.index for x in needed if x is not True) if self.owners else ()
        key = kind, point, whose
        if key not in self.levels:
            added = self._added(point, kind)
            if self.owners:
                self.levels[key] = self._owned_level(point, kind, added, needed)
            else:
                self.levels[key] = self.number.initial + added
        return self.levels[key]

    def _owned_level(self, point: Point, kind: str, added: Any, needed: Sequence[Any]) -> Any:
        reach = self._reach()
        level = self.model.new_int_var(-reach, reach, "")
        chosen: list[Any] = []
        for owner in self.owners:
            if owner.write is not None and owner.write.point == point and kind == "before":
                continue
            literal = self.model.new_bool_var("")
            chosen.append(literal)
            for when in () if owner.write is None else owner.write.when:
                self.model.add_implication(literal, when)
            self._owns(owner, literal, point, kind, needed)
            self.model.add(level == owner.level + added - owner.added).only_enforce_if(literal)
        unneeded = [~literal for literal in needed if literal is not True]
        if len(unneeded) < 2:
            self.model.add_exactly_one([*chosen, *unneeded])
        else:
            self.model.add_bool_or([*chosen, *unneeded])
            self.model.add_at_most_one(chosen)
        return level

    def _owns(
        self, owner: _Owner, literal: Literal, point: Point, kind: str, needed: Sequence[Any]
    ) -> None:
        """Makes an owner that is chosen for a happening own the number there."""
        if point == _END:
            until = self.happenings.end_of_all() if self.number.changes else self.last
            self.model.add(owner.start < until).only_enforce_if(literal)
            self.model.add(owner.end >= until).only_enforce_if(literal)
            return
        moment = self.order.moment(point)
        if kind == "after":
            self.model.add(owner.start <= moment).only_enforce_if(literal)
            self.model.add(owner.end >= moment + 1).only_enforce_if(literal)
            return
        self.model.add(owner.start + 1 <= moment).only_enforce_if(literal)
        self.model.add(owner.end >= moment).only_enforce_if(literal)
        changing = self._own_sets(point, needed)
        if not any(own is True for own in changing):
            beyond = self.model.add(owner.end >= moment + 1)
            beyond.only_enforce_if(literal, *(~own for own in changing))

    def _own_sets(self, point: Point, needed: Sequence[Any]) -> list[Any]:
        """Literals of which one is true where a happening itself sets the level.

        True among them: it always does, where the `needed` literals are true.
        """
        i, found = point[0], []
        known = {literal.index for literal in needed if literal is not True}
        for owner in self.owners:
            write = owner.write
            if write is None or write.point[0] != i or i < 0:
                continue
            if write.point != point and self.happenings.one_happening(i) is not None:
                continue
            literals: list[Any] = [literal for literal in write.when if literal.index not in known]
            if write.point != point:
                literals.append(~self.happenings.is_stretched(i))
            changing: Any = True
            for literal in literals:
                changing = self._both(changing, literal)
            found.append(changing)
        return found

    # --- demands ---

    def _after(self, write: _Write) -> tuple[Any, list[Any]]:
        """The level after an amount was added, and the literals under which there is one."""
        when = list(write.when)
        level = self._level(write.point, "before", when) + write.amount
        joint = self._joint(write)
        if joint is not None and not joint.sets:
            stretched = self.happenings.is_stretched(write.point[0])
            if not write.point[1]:
                return level, [*when, stretched]
            level = level + joint.amount * (1 - stretched)
        return level, when

    def _limits_that_bind(
        self, write: _Write, least: int | None, greatest: int | None
    ) -> tuple[int | None, int | None]:
        """The limits that an amount can break, if the level before it was within them."""
        if self._joint(write) is not None:
            return least, greatest
        return (
            least if write.amount < 0 else None,
            greatest if write.amount > 0 else None,
        )

    def _add_protected(self, write: _Write) -> None:
        """Limits that what runs needs and has lost are not broken again by a change while it runs.

        Either it is over, or the level before is beyond them, or the one after is within them.
        """
        i = write.point[0]
        for protected in () if i < 0 else self.problem.activities[i].details.protects_limits:
            limits = protected.condition
            if limits.number != self.k:
                continue
            after, when = (write.amount, [*write.when]) if write.sets else self._after(write)
            over, below, above, within = (self.model.new_bool_var("") for _ in range(4))
            if protected.activity < 0:
                self.model.add(over == 0)
            else:
                closing = self.happenings.point(protected.activity, at_end=True)
                self.model.add(self.order.moment(write.point) >= closing).only_enforce_if(over)
            before = self._level(write.point, "before", write.when)
            self._within(before, None, _below(limits.least), [below])
            self._within(before, _above(limits.greatest), None, [above])
            self._within(after, limits.least, limits.greatest, [within])
            beyond = [below] * (limits.least is not None) + [above] * (limits.greatest is not None)
            self.model.add_bool_or([over, within, *beyond, *(~literal for literal in when)])

    def _keep_bounds(self, write: _Write) -> None:
        if write.sets:
            if not self.number.allows(write.amount):
                self._within(write.amount, self.number.least, self.number.greatest, write.when)
            return
        limits = self._limits_that_bind(write, self.number.least, self.number.greatest)
        if limits != (None, None):
            level, when = self._after(write)
            self._within(level, *limits, when)

    def _add_condition(self, i: int, condition: NumberCondition, when: tuple[Literal, ...]) -> None:
        one = self.happenings.one_happening(i)
        if condition.at != "all" or one is True:
            self._add_read((i, condition.at == "end" and one is not True), condition, when)
        elif one is False:
            self._add_hold(i, condition, when)
        else:
            stretched = self.happenings.is_stretched(i)
            self._add_read((i, False), condition, [*when, ~stretched])
            self._add_hold(i, condition, [*when, stretched])

    def _add_read(self, point: Point, condition: NumberCondition, when: Sequence[Any]) -> None:
        level = self._level(point, "before", when)
        self._within(level, condition.least, condition.greatest, when)
        for write in self.touches.writes:
            if write.point == point or write.sets:
                continue  # (Ownership keeps apart what sets the level.)
            if {point, write.point} <= self.touches.strict:
                if not write.amount:
                    self.order.before(write.point, point)  # It changes nothing, but keeps apart.
            elif write.point[0] != point[0]:
                moment, other = self.order.moment(point), self.order.moment(write.point)
                literals = [~self.order.earlier(write.point, point), *write.when, *when]
                self.model.add(moment + 1 <= other).only_enforce_if(literals)

    def _add_hold(self, i: int, condition: NumberCondition, when: Sequence[Any]) -> None:
        """From just after the start to just before the end."""
        least, greatest = condition.least, condition.greatest
        level = self._level((i, False), "after", when)
        self._within(level, least, greatest, when)
        for write in self.touches.writes:
            if write.point[0] == i:
                continue
            inside = [self._after_opening(write, i), self._before_closing(write, i)]
            if write.sets:
                self._within(write.amount, least, greatest, [*when, *write.when, *inside])
                continue
            limits = self._limits_that_bind(write, least, greatest)
            if limits != (None, None):
                after, own = self._after(write)
                self._within(after, *limits, [*when, *own, *inside])

    def _after_opening(self, write: _Write, i: int) -> Any:
        start = (i, False)
        if {start, write.point} <= self.touches.strict:
            return ~self.order.before(write.point, start)
        return ~self.order.no_later(write.point, start)

    def _before_closing(self, write: _Write, i: int) -> Any:
        end = (i, True)
        if {end, write.point} <= self.touches.strict:
            return self.order.before(write.point, end)
        return self.order.earlier(write.point, end)


def _below(least: int | None) -> int | None:
    """The greatest level that is too low."""
    return None if least is None else least - 1


def _above(greatest: int | None) -> int | None:
    """The least level that is too high."""
    return None if greatest is None else greatest + 1
