"""A temporal planning problem as data, and its PDDL2.1 text: this module only prints.

Sections stand in the order of the BNF (Fox and Long, "PDDL2.1", JAIR 20, 2003, appendix A).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple


class NumericCondition(NamedTuple):
    """A condition on a counter: at the "start", the "end" or throughout ("all") it is `relation`
    the `amount`.
    """

    when: str
    relation: str
    counter: str
    amount: int


class NumericEffect(NamedTuple):
    """An amount that the start or the end adds to a counter (a negative one takes), or sets."""

    at_end: bool
    counter: str
    amount: int
    sets: bool = False


class Additions(NamedTuple):
    """Conditions and effects that an element of a problem adds to an operator."""

    at_start: tuple[str, ...] = ()
    over_all: tuple[str, ...] = ()
    at_end: tuple[str, ...] = ()
    start_deletes: tuple[str, ...] = ()
    start_adds: tuple[str, ...] = ()
    end_deletes: tuple[str, ...] = ()
    end_adds: tuple[str, ...] = ()
    needs: tuple[NumericCondition, ...] = ()
    changes: tuple[NumericEffect, ...] = ()


NOTHING = Additions()


@dataclass
class Operator:
    """A parameterless action. `duration` is (min, max) in planner time, None instant.

    Facts are names; `takes` maps a counter to the amount held from start to end. `needs` and
    `changes` are its other conditions on counters and effects on them.
    """

    name: str
    duration: tuple[int, int] | None
    at_start: list[str] = field(default_factory=list)
    over_all: list[str] = field(default_factory=list)
    at_end: list[str] = field(default_factory=list)
    start_adds: list[str] = field(default_factory=list)
    start_deletes: list[str] = field(default_factory=list)
    end_adds: list[str] = field(default_factory=list)
    end_deletes: list[str] = field(default_factory=list)
    takes: dict[str, int] = field(default_factory=dict)
    needs: list[NumericCondition] = field(default_factory=list)
    changes: list[NumericEffect] = field(default_factory=list)

    def add(self, more: Additions) -> None:
        """Adds conditions and effects."""
        for name, values in more._asdict().items():
            if values:
                getattr(self, name).extend(values)

    @property
    def required_facts(self) -> list[str]:
        """The facts of its conditions."""
        return [*self.at_start, *self.over_all, *self.at_end]


class TimedLiteral(NamedTuple):
    """At `time` (planner time) the fact becomes true or false by itself."""

    time: int
    fact: str
    value: bool


@dataclass
class Encoding:
    """A whole domain and problem."""

    facts: list[str] = field(default_factory=list)
    counters: dict[str, int] = field(default_factory=dict)
    operators: list[Operator] = field(default_factory=list)
    initial: list[str] = field(default_factory=list)
    timed: list[TimedLiteral] = field(default_factory=list)
    goal: list[str] = field(default_factory=list)
    numeric_goal: list[NumericCondition] = field(default_factory=list)
    metric: str = "minimize (total-time)"

    def drop_unused_facts(self) -> None:
        """Leaves out the facts that no condition and no goal requires."""
        used = {fact for operator in self.operators for fact in operator.required_facts}
        used.update(self.goal)
        if used.issuperset(self.facts):
            return
        self.facts = [fact for fact in self.facts if fact in used]
        self.initial = [fact for fact in self.initial if fact in used]
        self.timed = [literal for literal in self.timed if literal.fact in used]
        for o in self.operators:
            o.start_adds = [fact for fact in o.start_adds if fact in used]
            o.end_adds = [fact for fact in o.end_adds if fact in used]
            o.start_deletes = [fact for fact in o.start_deletes if fact in used]
            o.end_deletes = [fact for fact in o.end_deletes if fact in used]

    @property
    def requirements(self) -> list[str]:
        """The PDDL requirements that the domain uses."""
        durative = [o for o in self.operators if o.duration is not None]
        used = [":durative-actions"] if durative or not self.operators else []
        if any(o.duration is not None and o.duration[0] != o.duration[1] for o in durative):
            used.append(":duration-inequalities")
        if self.counters:
            used.append(":fluents")
        if self.timed:
            used.append(":timed-initial-literals")
        return used or [":strips"]

    def domain_text(self) -> str:
        """`domain.pddl`."""
        lines = [
            "(define (domain irc_task)",
            f"  (:requirements {' '.join(self.requirements)})",
            f"  (:predicates{_listed(self.facts)})",
        ]
        if self.counters:
            lines.append(f"  (:functions{_listed(list(self.counters))})")
        lines += [_operator(o) for o in self.operators]
        return "\n".join(lines) + ")\n"

    def problem_text(self) -> str:
        """`problem.pddl`."""
        lines = ["(define (problem irc_task_1)", "  (:domain irc_task)", "  (:init"]
        lines += [f"    ({fact})" for fact in self.initial]
        lines += [f"    (= ({name}) {value})" for name, value in self.counters.items()]
        lines += [
            f"    (at {t.time} ({t.fact}))" if t.value else f"    (at {t.time} (not ({t.fact})))"
            for t in self.timed
        ]
        lines[-1] += ")"
        goals = [f"({fact})" for fact in self.goal] + [_comparison(n) for n in self.numeric_goal]
        lines.append("  (:goal (and" + "".join(f"\n    {goal}" for goal in goals) + "))")
        lines.append(f"  (:metric {self.metric}))")
        return "\n".join(lines) + "\n"


def _listed(names: list[str]) -> str:
    return "".join(f"\n    ({name})" for name in names)


def _operator(o: Operator) -> str:
    return _instant(o) if o.duration is None else _durative(o)


def _instant(o: Operator) -> str:
    conditions = [f"({f})" for f in dict.fromkeys((*o.at_start, *o.at_end, *o.over_all))]
    conditions += dict.fromkeys(_comparison(n) for n in o.needs)
    deletes = dict.fromkeys((*o.start_deletes, *o.end_deletes))
    effects = [f"(not ({f}))" for f in deletes]
    effects += [f"({f})" for f in dict.fromkeys((*o.start_adds, *o.end_adds))]
    effects += [_numeric_effect(c) for c in o.changes]
    return (
        f"  (:action {o.name}\n"
        f"    :parameters ()\n"
        f"    :precondition (and{''.join(f' {c}' for c in conditions)})\n"
        f"    :effect (and {' '.join(effects)}))"
    )


def _comparison(n: NumericCondition) -> str:
    return f"({n.relation} ({n.counter}) {n.amount})"


def _numeric_effect(c: NumericEffect) -> str:
    if c.sets:
        return f"(assign ({c.counter}) {c.amount})"
    verb = "decrease" if c.amount < 0 else "increase"
    return f"({verb} ({c.counter}) {abs(c.amount)})"


_WHEN = {"start": "at start", "all": "over all", "end": "at end"}


def _point(at_end: bool) -> str:
    return "at end" if at_end else "at start"


def _durative(o: Operator) -> str:
    shortest, longest = o.duration or (0, 0)
    if shortest == longest:
        duration = f"(= ?duration {shortest})"
    else:
        duration = f"(and (>= ?duration {shortest}) (<= ?duration {longest}))"
    return (
        f"  (:durative-action {o.name}\n"
        f"    :parameters ()\n"
        f"    :duration {duration}\n"
        f"    :condition (and {' '.join(_timed_conditions(o))})\n"
        f"    :effect (and {' '.join(_timed_effects(o))}))"
    )


def _timed_conditions(o: Operator) -> list[str]:
    conditions = [f"(at start ({f}))" for f in o.at_start]
    conditions += [f"(at start (>= ({c}) {n}))" for c, n in o.takes.items()]
    conditions += [f"(over all ({f}))" for f in o.over_all]
    conditions += [f"(at end ({f}))" for f in o.at_end]
    conditions += [f"({_WHEN[n.when]} {_comparison(n)})" for n in o.needs]
    return conditions


def _timed_effects(o: Operator) -> list[str]:
    effects = [f"(at start (not ({f})))" for f in o.start_deletes]
    effects += [f"(at start ({f}))" for f in o.start_adds]
    effects += [f"(at start (decrease ({c}) {n}))" for c, n in o.takes.items()]
    effects += [f"(at end (not ({f})))" for f in o.end_deletes]
    effects += [f"(at end ({f}))" for f in o.end_adds]
    effects += [f"(at end (increase ({c}) {n}))" for c, n in o.takes.items()]
    effects += [f"({_point(c.at_end)} {_numeric_effect(c)})" for c in o.changes]
    return effects
