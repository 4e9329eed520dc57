"""`Problem` → PDDL2.1: parameterless actions, positive conditions only.

Every activity has a fact `todo` that its start takes away and a fact `done` that its end gives.
A precedence is a condition on such facts; a minimum lag is a planner-only *wait* between them; a
maximum lag (or a negative minimum) is a planner-only *envelope*: it must have begun before the
one point and must still run at the other, and it is no longer than the lag. Windows are timed
initial literals. Capacity is one token fact for each unit (measured: numeric counters let a
planner take and give back at one instant, which validators reject); only where tokens would
multiply beyond a budget a counter takes their place, and the re-timed plan is validated anyway.

An optional activity is not in the goal. Where others wait for it, or it belongs to a group, a
planner-only instant *declines* it: it takes all `todo` facts away and gives all `done` facts, so
that it happens before all of the members start or not at all.

Planners separate dependent happenings by an epsilon, so a chain of k of them ends k epsilons
late. What bounds time from above therefore gets `slack`, and one tick is `scale` planner units,
so that all slack together stays below one tick: then an exact integer schedule with the same
choices and order exists (a relaxed cycle of the temporal network is short of 0 by less than 1,
and weights are whole).
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import ceil
from typing import Any

from irc.lowering.choices import NEVER
from irc.passes.restrict import drop_ample_stock, settle_presence
from irc.problem import PLAIN, Activity, Problem
from irc.targets import Refusal
from irc_pddl21.domain import Change, Comparison, Encoding, Operator, TimedLiteral
from irc_pddl21.grounded import Grounded, Meaning, names_of
from irc_pddl21.names import NameTable
from irc_pddl21.occurrences import Absence, Occurrences, absences, occurrences_of
from irc_pddl21.orders import Point, sort_constraints
from irc_pddl21.state import StateFacts, contradicts_itself
from irc_pddl21.stock import Stock
from irc_pddl21.units import MAX_VARIANTS as MAX_VARIANTS
from irc_pddl21.units import span_of, units_of
from irc_pddl21.variants import Variant, variants_of

DOMAIN_FILE, PROBLEM_FILE = "domain.pddl", "problem.pddl"

EPSILON = Fraction(1, 1000)
"""The separation of dependent happenings in OPTIC and kairos, in planner time."""

ENDLESS = 64
"""So many occurrences of what may happen without end are reckoned with where epsilons add up.
(A plan with more of them may miss a limit by an epsilon; what cannot be re-timed is not used.)"""

_GREATEST_SCALE = 10_000


def encode(problem: Problem, epsilon: Fraction = EPSILON, *, loose: bool = False) -> Grounded:
    """The problem as operators and facts, for planners with the given epsilon.

    `loose`: with actions that are shorter by the slack; see `irc_pddl21.loose`.

    Raises `Refusal` where an activity has too many ways to be carried out, or none.
    """
    return _Encoder(drop_ample_stock(settle_presence(problem)), epsilon, loose=loose).run()


def encode_files(problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
    """The two PDDL files, and the meaning of their names and numbers for the manifest."""
    grounded = encode(problem)
    files = {
        DOMAIN_FILE: grounded.encoding.domain_text(),
        PROBLEM_FILE: grounded.encoding.problem_text(),
    }
    return files, names_of(grounded)


class _Encoder:
    def __init__(self, problem: Problem, epsilon: Fraction, *, loose: bool) -> None:
        self.problem = problem
        self.loose = loose
        self.names = NameTable()
        self.encoding = Encoding()
        order = sorted(
            range(len(problem.activities)),
            key=lambda i: (-(problem.activities[i].duration_min + problem.tails[i]), i),
        )
        self.order = order
        self.base = {i: self.names.new(problem.activities[i].id) for i in range(len(order))}
        self.occurrences = [occurrences_of(a) for a in problem.activities]
        facts, waits, envelopes = sort_constraints(problem)
        self.fact_arcs, self.envelopes = facts, envelopes
        self.absences = absences(problem, [*facts, *waits])
        self.declined = {i for absence in self.absences for i in absence.members}
        self.waits: dict[tuple[Point, int], list[Point]] = {}
        for arc in waits:
            self.waits.setdefault((arc.frm, arc.lag), []).append(arc.to)
        self.scale, self.slack = self._scale(epsilon)
        self.out = Grounded(self.encoding, self.scale, self.slack, loose=loose)
        self.begun: set[int] = set()
        self.lag_facts: dict[int, list[str]] = {}
        self.conditions: list[list[str]] = [[] for _ in range(2 * len(order))]

    def _scale(self, epsilon: Fraction) -> tuple[int, int]:
        """Planner units per tick, and the slack of each constraint that bounds from above."""
        closings = len(self.envelopes) + sum(
            self.problem.effective_deadline(i) is not None
            or a.start is not None
            or self._has_calendar(a)
            for i, a in enumerate(self.problem.activities)
        )
        if self.loose:
            # Every action is one, and times are rounded to the nearest tick.
            closings = 2 * (closings + len(self.problem.activities))
        if not closings:
            return 1, 0
        operators = sum(
            o.written + (ENDLESS if o.again is None else o.again) for o in self.occurrences
        )
        operators += len(self.waits) + len(self.envelopes) + len(self.absences)
        slack = ceil(epsilon * 2 * (operators + 1))
        scale = 10
        while scale <= slack * (closings + 1) and scale < _GREATEST_SCALE:
            scale *= 10
        while scale <= 2 * slack:
            scale *= 10
        return scale, slack

    def _has_calendar(self, activity: Activity) -> bool:
        shared = self.problem.shared
        return any(shared[r].windows for c in activity.claims for r in c.alternatives)

    def run(self) -> Grounded:
        self._precedence()
        self._lags()
        self._envelopes()
        self._windows()
        self.units = units_of(self.problem, self.names, self.out)
        self.state = StateFacts(self.problem, self.names)
        self.encoding.facts += self.state.facts.values()
        self.encoding.initial += self.state.initial
        self.out.state.update(self.state.meanings)
        self.stock = Stock(self.problem, self.names, self.encoding)
        self.out.tokens.update(self.stock.meanings)
        self.worth = self._worth()
        for i in self.order:
            self._activity(i)
        for absence in self.absences:
            self._decline(absence)
        self.encoding.goal += [self.state.facts[goal] for goal in self.problem.goals]
        self.encoding.forget_unasked()
        return self.out

    def _fact(self, name: str, *, initially: bool = False) -> str:
        self.encoding.facts.append(name)
        if initially:
            self.encoding.initial.append(name)
        return name

    def _require(self, point: Point, fact: str) -> None:
        """Makes a fact a condition of the happening at a point."""
        self.conditions[point].append(fact)

    def _reached(self, point: Point) -> str:
        """The fact that says a point has passed."""
        i, is_end = divmod(point, 2)
        if is_end:
            return f"done_{self.base[i]}"
        self.begun.add(i)
        return f"begun_{self.base[i]}"

    def _label(self, point: Point) -> str:
        return self.base[point // 2] + ("" if point % 2 else "_start")

    def _describe(self, point: Point) -> str:
        end = "end" if point % 2 else "start"
        return f"the {end} of {self.problem.activities[point // 2].id!r}"

    def _precedence(self) -> None:
        for arc in self.fact_arcs:
            self._require(arc.to, self._reached(arc.frm))

    def _lags(self) -> None:
        for (frm, lag), followers in self.waits.items():
            name = self.names.new(f"wait_{lag}_after_{self._label(frm)}")
            todo = self._fact(f"todo_{name}", initially=True)
            over = self._fact(f"lag_{name}")
            self.lag_facts.setdefault(frm // 2, []).append(over)
            duration = lag * self.scale
            self.encoding.operators.append(
                Operator(
                    name,
                    (duration, duration),
                    at_start=[todo, self._reached(frm)],
                    start_deletes=[todo],
                    end_adds=[over],
                )
            )
            self.out.planner_only[name] = f"{lag} ticks after {self._describe(frm)}"
            for point in followers:
                self._require(point, over)

    def _envelopes(self) -> None:
        """`time(frm) <= time(to) - lag` with lag <= 0, as an envelope around both points."""
        for frm, to, lag in self.envelopes:
            name = self.names.new(f"keep_{self._label(frm)}_by_{self._label(to)}")
            todo = self._fact(f"todo_{name}", initially=True)
            begun, running = self._fact(f"after_{name}"), self._fact(f"during_{name}")
            self.encoding.operators.append(
                Operator(
                    name,
                    (0, -lag * self.scale + self.slack),
                    at_start=[todo],
                    start_deletes=[todo],
                    start_adds=[begun, running],
                    end_deletes=[running],
                )
            )
            self.out.planner_only[name] = (
                f"{self._describe(frm)} is at most {-lag} ticks after {self._describe(to)}"
            )
            self._require(to, begun)
            self._require(frm, running)

    def _windows(self) -> None:
        self.over_all: dict[int, str] = {}
        opened: dict[int, str] = {}
        closed: dict[int, str] = {}
        for i, activity in enumerate(self.problem.activities):
            release = max(activity.release, activity.start or 0)
            if release:
                self._require(2 * i, self._released(release, opened))
            if activity.start is not None:
                self._require(2 * i, self._open_until(activity.start, closed))
            deadline = self.problem.effective_deadline(i)
            if deadline is not None:
                self.over_all[i] = self._open_until(deadline, closed)

    def _released(self, release: int, opened: dict[int, str]) -> str:
        if release not in opened:
            opened[release] = self._fact(f"released_{release}")
            literal = TimedLiteral(release * self.scale, opened[release], True)
            self.encoding.timed.append(literal)
        return opened[release]

    def _open_until(self, time: int, closed: dict[int, str]) -> str:
        time = max(time, NEVER)
        if time == NEVER and time not in closed:
            closed[time] = self._fact("open_never")  # Literals cannot come before the beginning.
        if time not in closed:
            closed[time] = self._fact(f"open_{time}", initially=True)
            literal = TimedLiteral(time * self.scale + self.slack, closed[time], False)
            self.encoding.timed.append(literal)
        return closed[time]

    def _worth(self) -> dict[int, int]:
        """What each occurrence adds to the counter of the first objective, if that is one.

        A group is worth its reward when its first member is there, for then all are.
        """
        first = self.problem.objectives[0]
        self.out.beyond = self.problem.objectives[1:]
        worth: dict[int, int] = {}
        if first == "reward":
            worth = {i: a.details.reward for i, a in enumerate(self.problem.activities)}
            for group in self.problem.groups:
                worth[group.members[0]] += group.reward
        elif first == "cost":
            worth = {i: a.details.cost for i, a in enumerate(self.problem.activities)}
        if not any(worth.values()):
            return {}
        self.worth_counter = self.names.new(f"sum_of_{first}")
        self.encoding.counters[self.worth_counter] = 0
        self.out.tokens[self.worth_counter] = f"the {first} so far"
        direction = "maximize" if first == "reward" else "minimize"
        self.encoding.metric = f"{direction} ({self.worth_counter})"
        return worth

    def _decline(self, absence: Absence) -> None:
        if absence.group is None:
            told = f"action {self.problem.activities[absence.members[0]].id!r}"
            text = f"skip_{self.base[absence.members[0]]}"
        else:
            group = self.problem.groups[absence.group]
            told, text = f"group {group.id!r}", f"decline_{group.id}"
        name = self.names.new(text)
        todo = [f"todo_{self.base[i]}" for i in absence.members]
        given: list[str] = []
        for i in absence.members:
            given += [f"done_{self.base[i]}", *self.lag_facts.get(i, ())]
            given += [f"begun_{self.base[i]}"] if i in self.begun else []
        self.encoding.operators.append(
            Operator(name, None, at_start=todo, start_deletes=todo, start_adds=given)
        )
        self.out.planner_only[name] = f"{told} is absent"

    def _activity(self, i: int) -> None:
        activity, base, occurrences = self.problem.activities[i], self.base[i], self.occurrences[i]
        if activity.details is PLAIN and not activity.claims and i not in self.worth:
            self._plain(i, activity, base)
            return
        variants = [
            v
            for v in variants_of(self.problem, activity, self.units)
            if not contradicts_itself(activity, instant=not span_of(activity, v.mode)[1])
        ]
        if not variants and occurrences.least:
            raise Refusal(
                f"action {activity.id!r} must be there, but there is no way to carry it out: it "
                "asks for more than there is, or one of its happenings gives a variable two values",
                activity.origin,
                "every target would find it infeasible",
            )
        done = ""
        for k in range(1, occurrences.written + 1):
            own = base if k == 1 else self.names.new(f"{base}_{k}")
            todo = self._fact(f"todo_{own}", initially=True)
            after = [done] if done else []
            done = self._fact(f"done_{own}")
            if k <= occurrences.least or i in self.declined:
                self.encoding.goal.append(done)
            begun = [self._fact(f"begun_{own}")] if i in self.begun else []
            last = k == occurrences.written and occurrences.again != 0
            idle = [self._fact(f"idle_{base}")] if last else []
            self._operators(i, own, variants, [todo, *after], [todo], begun, [done, *idle])
        if occurrences.again != 0:
            self._again(i, variants, occurrences)

    def _plain(self, i: int, activity: Activity, base: str) -> None:
        """By far the most frequent kind: it happens once, and in one way."""
        todo = self._fact(f"todo_{base}", initially=True)
        done = self._fact(f"done_{base}")
        self.encoding.goal.append(done)
        span = activity.duration_min, activity.duration_max
        self.encoding.operators.append(
            Operator(
                base,
                self._lasting(span) if span[1] else None,
                at_start=[todo, *self.conditions[2 * i]],
                over_all=self._holding(i),
                at_end=self.conditions[2 * i + 1],
                start_deletes=[todo],
                start_adds=[self._fact(f"begun_{base}")] if i in self.begun else [],
                end_adds=[done],
            )
        )
        self.out.actions[base] = Meaning(activity.id, None, ())

    def _again(self, i: int, variants: list[Variant], occurrences: Occurrences) -> None:
        """What can happen again and again: once the occurrence before has ended."""
        base = self.base[i]
        idle = f"idle_{base}"
        if not occurrences.written:
            self._fact(idle, initially=True)
        own = self.names.new(f"{base}_again") if occurrences.written else base
        needs: list[Comparison] = []
        changes: list[Change] = []
        if occurrences.again is not None:
            left = self.names.new(f"left_for_{base}")
            self.encoding.counters[left] = occurrences.again
            self.out.tokens[left] = "how often the action may still happen"
            needs.append(Comparison(False, ">=", left, 1))
            changes.append(Change(False, left, -1))
        self._operators(i, own, variants, [idle], [idle], [], [idle], needs, changes)

    def _operators(
        self,
        i: int,
        base: str,
        variants: list[Variant],
        at_start: list[str],
        start_deletes: list[str],
        start_adds: list[str],
        end_adds: list[str],
        needs: list[Comparison] | None = None,
        changes: list[Change] | None = None,
    ) -> None:
        """One operator for each variant of an occurrence, with the activity's own conditions."""
        activity = self.problem.activities[i]
        for variant in variants:
            span = span_of(activity, variant.mode)
            name = base
            if len(variants) > 1:
                name = self.names.new(f"{base}__{'__'.join(_parts(activity, variant))}")
            here = list(
                dict.fromkeys(self.units.here[t] for t in variant.tokens if t in self.units.here)
            )
            stock_needs, stock_changes = self.stock.of(activity, instant=not span[1])
            start = self.state.effects(activity, at_end=False)
            end = self.state.effects(activity, at_end=True)
            worth = self.worth.get(i, 0)
            counted = [Change(True, self.worth_counter, worth)] if worth else []
            self.encoding.operators.append(
                Operator(
                    name,
                    self._lasting(span) if span[1] else None,
                    at_start=[
                        *at_start,
                        *self.conditions[2 * i],
                        *self.state.conditions(activity, "start"),
                        *here,
                        *variant.tokens,
                    ],
                    over_all=[
                        *self._holding(i),
                        *self.state.conditions(activity, "all"),
                        *here,
                    ],
                    at_end=[
                        *self.conditions[2 * i + 1],
                        *self.state.conditions(activity, "end"),
                    ],
                    start_deletes=[*start_deletes, *start[1], *variant.tokens],
                    start_adds=[*start_adds, *start[0]],
                    end_deletes=end[1],
                    end_adds=[*end_adds, *end[0], *variant.tokens],
                    takes=dict(variant.takes),
                    needs=[*(needs or ()), *stock_needs],
                    changes=[*(changes or ()), *stock_changes, *counted],
                )
            )
            self.out.actions[name] = Meaning(
                activity.id,
                None if variant.mode is None else activity.details.modes[variant.mode].id,
                tuple(
                    (claim.use, self.problem.shared[r].id)
                    for claim, r in zip(variant.claims, variant.resources, strict=True)
                ),
            )

    def _lasting(self, span: tuple[int, int]) -> tuple[int, int]:
        """Planner time from start to end: least and greatest."""
        least, greatest = span
        shorter = self.slack if self.loose else 0
        return max(0, least * self.scale - shorter), greatest * self.scale - (
            shorter if least == greatest else 0
        )

    def _holding(self, i: int) -> list[str]:
        return [self.over_all[i]] if i in self.over_all else []


def _parts(activity: Activity, variant: Variant) -> list[str]:
    """What tells a variant apart: its mode and its tokens (without "free_")."""
    mode = [] if variant.mode is None else [activity.details.modes[variant.mode].id]
    return mode + [token[5:] for token in variant.tokens]
