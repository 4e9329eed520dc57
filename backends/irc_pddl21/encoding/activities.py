"""Activities in PDDL: an operator for each occurrence and each way to carry it out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from irc.problem import PLAIN, Activity, Problem
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.couplings import CouplingFacts
from irc_pddl21.encoding.grounded import Meaning
from irc_pddl21.encoding.modes import in_mode, span_of
from irc_pddl21.encoding.numbers import NumberFluents, gives_two_levels
from irc_pddl21.encoding.objectives import ObjectiveCounter
from irc_pddl21.encoding.occurrences import Occurrences, occurrences_of
from irc_pddl21.encoding.pddl import Additions, NumericCondition, NumericEffect, Operator
from irc_pddl21.encoding.reservoirs import ReservoirLevels
from irc_pddl21.encoding.resources import ResourceUnits
from irc_pddl21.encoding.selections import SelectionFacts
from irc_pddl21.encoding.setups import SetupFacts
from irc_pddl21.encoding.state import StateFacts, contradicts_itself
from irc_pddl21.encoding.variants import Variant, variants_of
from irc_pddl21.encoding.work import WorkFacts


class Elements(NamedTuple):
    """The other elements of a problem, as far as activities have conditions and effects on them.

    `declined` are the activities (by index) for which a planner-only instant declares the absence.
    """

    units: ResourceUnits
    state: StateFacts
    levels: ReservoirLevels
    numbers: NumberFluents
    objective: ObjectiveCounter
    couplings: CouplingFacts
    selections: SelectionFacts
    setups: SetupFacts
    work: WorkFacts
    declined: frozenset[int]

    def are_alone(self, i: int, activity: Activity) -> bool:
        """Whether an activity has nothing but time and precedence."""
        return (
            activity.details is PLAIN
            and not activity.open_demands
            and i not in self.objective.amounts
            and i not in self.couplings.members
            and not self.selections.of(i)
        )


@dataclass(frozen=True)
class _OccurrenceFacts:
    """The conditions and effects that make an occurrence happen once, and in its turn."""

    at_start: list[str]
    start_deletes: list[str]
    start_adds: list[str]
    end_adds: list[str]
    needs: list[NumericCondition] = field(default_factory=list)
    changes: list[NumericEffect] = field(default_factory=list)


class _TimedVariant(NamedTuple):
    """A variant of an activity, its time from start to end, and what other elements add to it."""

    variant: Variant
    span: tuple[int, int]
    additions: tuple[Additions, ...] = ()


def add_activities(builder: Builder, elements: Elements) -> None:
    """Adds the operators of every activity, those with most work behind them first.

    Raises `Refusal` where an activity that must be present cannot be carried out.
    """
    activities, tails = builder.problem.activities, builder.problem.bounds.tails
    encoder = _ActivityEncoder(builder, elements)
    for i in sorted(
        range(len(activities)), key=lambda i: (-(activities[i].duration_min + tails[i]), i)
    ):
        encoder.add(i, activities[i])


class _ActivityEncoder:
    """Adds activities one by one."""

    def __init__(self, builder: Builder, elements: Elements) -> None:
        self.builder, self.elements = builder, elements
        self.names, self.encoding = builder.names, builder.encoding

    def add(self, i: int, activity: Activity) -> None:
        """Adds the operators of one activity."""
        if self.elements.are_alone(i, activity):
            self._add_plain(i, activity)
            return
        occurrences = occurrences_of(activity)
        untimed = [
            (variant, more)
            for variant in variants_of(self.builder.problem, i, self.elements.units)
            if (more := self._additions(i, variant)) is not None
        ]
        if not untimed and occurrences.least:
            raise _impossible(activity)
        # (Where no open time is left for what must happen, the goal cannot be reached.)
        variants = [
            _TimedVariant(variant, timing.span, (*more, timing.additions))
            for variant, more in untimed
            for timing in self.elements.work.of(i, variant)
        ]
        self._add_chain(i, variants, occurrences)
        if occurrences.again != 0:
            self._add_reusable(i, variants, occurrences)

    def _additions(self, i: int, variant: Variant) -> list[Additions] | None:
        """The additions of couplings and set-ups to a variant; None where it contradicts itself."""
        activity = in_mode(self.builder.problem.activities[i], variant.mode)
        ties = self.elements.couplings.of(i, variant)
        if ties is None or self._contradicts_itself(activity, instant=not variant.span[1]):
            return None
        return [*ties, *self.elements.setups.of(i, variant)]

    def _contradicts_itself(self, activity: Activity, *, instant: bool) -> bool:
        """Whether one happening of an activity gives a variable or a number two values."""
        return contradicts_itself(activity, instant=instant) or gives_two_levels(
            self.builder.problem, activity, instant=instant
        )

    def _add_plain(self, i: int, activity: Activity) -> None:
        """Adds by far the most frequent kind, which happens once, and in one way."""
        base, conditions = self.builder.base[i], self.builder.conditions
        todo = self.builder.fact(f"todo_{base}", initially=True)
        done = self.builder.fact(f"done_{base}")
        self.encoding.goal.append(done)
        span = activity.duration_min, activity.duration_max
        self.encoding.operators.append(
            Operator(
                base,
                self.builder.scale.duration(*span) if span[1] else None,
                at_start=[todo, *conditions[2 * i]],
                over_all=self._deadline(i),
                at_end=conditions[2 * i + 1],
                start_deletes=[todo],
                start_adds=self._begun(i, base),
                end_adds=[done],
            )
        )
        self.builder.grounded.actions[base] = Meaning(activity.id, None, ())

    def _add_chain(self, i: int, variants: list[_TimedVariant], occurrences: Occurrences) -> None:
        """Adds the occurrences that are written out, each after the previous one."""
        base, done = self.builder.base[i], ""
        for k in range(1, occurrences.written + 1):
            own = base if k == 1 else self.names.new(f"{base}_{k}")
            todo = self.builder.fact(f"todo_{own}", initially=True)
            after = [done] if done else []
            done = self.builder.fact(f"done_{own}")
            if k <= occurrences.least or i in self.elements.declined:
                self.encoding.goal.append(done)
            begun = self._begun(i, own)
            last = k == occurrences.written and occurrences.again != 0
            idle = [self.builder.fact(f"idle_{base}")] if last else []
            counted = self.elements.selections.of(i) if k == 1 else []
            facts = _OccurrenceFacts([todo, *after], [todo], begun, [done, *idle])
            self._add_variants(i, own, variants, facts, counted)

    def _add_reusable(
        self, i: int, variants: list[_TimedVariant], occurrences: Occurrences
    ) -> None:
        """Adds an operator that can be used again once the previous occurrence has ended."""
        base = self.builder.base[i]
        idle = f"idle_{base}"
        if not occurrences.written:
            self.builder.fact(idle, initially=True)
        own = self.names.new(f"{base}_again") if occurrences.written else base
        facts = _OccurrenceFacts([idle], [idle], [], [idle])
        if occurrences.again is not None:
            left = self.names.new(f"left_for_{base}")
            self.encoding.counters[left] = occurrences.again
            self.builder.grounded.tokens[left] = "how often the action may still happen"
            facts.needs.append(NumericCondition("start", ">=", left, 1))
            facts.changes.append(NumericEffect(False, left, -1))
        self._add_variants(i, own, variants, facts)

    def _add_variants(
        self,
        i: int,
        base: str,
        variants: list[_TimedVariant],
        facts: _OccurrenceFacts,
        more: Sequence[Additions] = (),
    ) -> None:
        """Adds one operator for each variant of an occurrence."""
        activity = self.builder.problem.activities[i]
        for timed in variants:
            name = base
            if len(variants) > 1:
                parts = _parts(self.builder.problem, activity, timed)
                name = self.names.new(f"{base}__{'__'.join(parts)}")
            operator = self._operator(i, name, timed, facts)
            for additions in (*timed.additions, *more):
                operator.add(additions)
            self.encoding.operators.append(operator)
            self.builder.grounded.actions[name] = self._meaning(activity, timed.variant)

    def _operator(
        self, i: int, name: str, timed: _TimedVariant, facts: _OccurrenceFacts
    ) -> Operator:
        """One variant of an occurrence, with the activity's own conditions and effects."""
        activity, state = self.builder.problem.activities[i], self.elements.state
        variant, span = timed.variant, timed.span
        activity = in_mode(activity, variant.mode)
        conditions = self.builder.conditions
        here = self.elements.units.presence_of(activity, variant.tokens)
        level_needs, level_changes = self.elements.levels.of(activity, instant=not span[1])
        numbers = self.elements.numbers
        number_needs, number_changes = numbers.of(activity, instant=not span[1])
        start_adds, start_deletes = state.effects(activity, at_end=False)
        end_adds, end_deletes = state.effects(activity, at_end=True)
        at_start, at_end = state.conditions(activity, "start"), state.conditions(activity, "end")
        over_all = state.conditions(activity, "all")
        return Operator(
            name,
            self.builder.scale.duration(*span) if span[1] else None,
            at_start=[*facts.at_start, *conditions[2 * i], *at_start, *here, *variant.tokens],
            over_all=[*self._deadline(i), *over_all, *here],
            at_end=[*conditions[2 * i + 1], *at_end],
            start_deletes=[*facts.start_deletes, *start_deletes, *variant.tokens],
            start_adds=[*facts.start_adds, *start_adds],
            end_deletes=end_deletes,
            end_adds=[*facts.end_adds, *end_adds, *variant.tokens],
            takes=dict(variant.takes),
            needs=[*facts.needs, *level_needs, *number_needs],
            changes=[
                *facts.changes,
                *level_changes,
                *number_changes,
                *self._counted(i, variant.mode),
            ],
        )

    def _meaning(self, activity: Activity, variant: Variant) -> Meaning:
        pools = self.builder.problem.contention.pools
        return Meaning(
            activity.id,
            None if variant.mode is None else activity.details.modes[variant.mode].id,
            tuple(
                (demand.use, pools[r].id)
                for demand, r in zip(variant.demands, variant.resources, strict=True)
            ),
        )

    def _begun(self, i: int, name: str) -> list[str]:
        return [self.builder.fact(f"begun_{name}")] if i in self.builder.begun else []

    def _deadline(self, i: int) -> list[str]:
        deadline_facts = self.builder.deadline_facts
        return [deadline_facts[i]] if i in deadline_facts else []

    def _counted(self, i: int, mode: int | None) -> list[NumericEffect]:
        """The effect on the counter of the first objective."""
        objective = self.elements.objective
        amount = objective.amounts.get(i, 0) + objective.of_modes.get((i, mode), 0)
        return [NumericEffect(True, objective.counter, amount)] if amount else []


def _impossible(activity: Activity) -> Refusal:
    return Refusal(
        f"action {activity.id!r} must be there, but there is no way to carry it out: it "
        "asks for more than there is, or one of its happenings gives a variable two values",
        activity.origin,
        "every target would find it infeasible",
    )


def _parts(problem: Problem, activity: Activity, timed: _TimedVariant) -> list[str]:
    """The parts of a variant's name: its mode, its tokens (without "free_"), its pause."""
    variant = timed.variant
    parts = [] if variant.mode is None else [activity.details.modes[variant.mode].id]
    span = span_of(activity, variant.mode)
    if not variant.span[1]:
        pools = problem.contention.pools
        parts += [pools[r].id for r in variant.resources]
        return [*parts, *(["at_once"] if span[1] else [])] or ["at_once"]
    parts += [token[5:] for token in variant.tokens]
    if activity.details.work:
        parts.append(f"pause_{timed.span[0] - variant.span[0]}")
    return parts
