"""A temporal planning problem as data, and its PDDL2.1 text: this module only prints.

Sections stand in the order of the BNF (Fox and Long, "PDDL2.1", JAIR 20, 2003, appendix A).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple


class Comparison(NamedTuple):
    """A condition on a counter: at the start, or at the end, it is `relation` the `amount`."""

    at_end: bool
    relation: str
    counter: str
    amount: int


class Change(NamedTuple):
    """What the start or the end adds to a counter; a negative amount takes."""

    at_end: bool
    counter: str
    amount: int


@dataclass
class Operator:
    """A parameterless action. `duration` is (min, max) in planner time, None instant.

    Facts are names; `takes` maps a counter to the amount held from start to end. `needs` and
    `changes` are what else it asks of counters and does to them.
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
    needs: list[Comparison] = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)

    @property
    def asked(self) -> list[str]:
        """The facts of its conditions."""
        return [*self.at_start, *self.over_all, *self.at_end]


@dataclass
class TimedLiteral:
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
    metric: str = "minimize (total-time)"

    def forget_unasked(self) -> None:
        """Leaves out the facts that no condition and no goal asks for."""
        asked = {fact for operator in self.operators for fact in operator.asked}
        asked.update(self.goal)
        if asked.issuperset(self.facts):
            return
        self.facts = [fact for fact in self.facts if fact in asked]
        self.initial = [fact for fact in self.initial if fact in asked]
        self.timed = [literal for literal in self.timed if literal.fact in asked]
        for o in self.operators:
            o.start_adds = [fact for fact in o.start_adds if fact in asked]
            o.end_adds = [fact for fact in o.end_adds if fact in asked]
            o.start_deletes = [fact for fact in o.start_deletes if fact in asked]
            o.end_deletes = [fact for fact in o.end_deletes if fact in asked]

    @property
    def requirements(self) -> list[str]:
        """The PDDL requirements that are really used."""
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
        lines.append("  (:goal (and" + "".join(f"\n    ({fact})" for fact in self.goal) + "))")
        lines.append(f"  (:metric {self.metric}))")
        return "\n".join(lines) + "\n"


def _listed(names: list[str]) -> str:
    return "".join(f"\n    ({name})" for name in names)


def _operator(o: Operator) -> str:
    return _instant(o) if o.duration is None else _durative(o)


def _instant(o: Operator) -> str:
    conditions = [f"({f})" for f in dict.fromkeys((*o.at_start, *o.at_end, *o.over_all))]
    conditions += [f"({n.relation} ({n.counter}) {n.amount})" for n in o.needs]
    deletes = dict.fromkeys((*o.start_deletes, *o.end_deletes))
    effects = [f"(not ({f}))" for f in deletes]
    effects += [f"({f})" for f in dict.fromkeys((*o.start_adds, *o.end_adds))]
    effects += [_change(c) for c in o.changes]
    return (
        f"  (:action {o.name}\n"
        f"    :parameters ()\n"
        f"    :precondition (and{''.join(f' {c}' for c in conditions)})\n"
        f"    :effect (and {' '.join(effects)}))"
    )


def _change(c: Change) -> str:
    verb = "decrease" if c.amount < 0 else "increase"
    return f"({verb} ({c.counter}) {abs(c.amount)})"


def _point(at_end: bool) -> str:
    return "at end" if at_end else "at start"


def _durative(o: Operator) -> str:
    shortest, longest = o.duration or (0, 0)
    if shortest == longest:
        duration = f"(= ?duration {shortest})"
    else:
        duration = f"(and (>= ?duration {shortest}) (<= ?duration {longest}))"
    conditions = [f"(at start ({f}))" for f in o.at_start]
    if o.takes:
        conditions += [f"(at start (>= ({c}) {n}))" for c, n in o.takes.items()]
    if o.over_all or o.at_end:
        conditions += [f"(over all ({f}))" for f in o.over_all]
        conditions += [f"(at end ({f}))" for f in o.at_end]
    conditions += [f"({_point(n.at_end)} ({n.relation} ({n.counter}) {n.amount}))" for n in o.needs]
    effects = [f"(at start (not ({f})))" for f in o.start_deletes]
    effects += [f"(at start ({f}))" for f in o.start_adds]
    effects += [f"(at start (decrease ({c}) {n}))" for c, n in o.takes.items()]
    effects += [f"(at end (not ({f})))" for f in o.end_deletes]
    effects += [f"(at end ({f}))" for f in o.end_adds]
    effects += [f"(at end (increase ({c}) {n}))" for c, n in o.takes.items()]
    effects += [f"({_point(c.at_end)} {_change(c)})" for c in o.changes]
    return (
        f"  (:durative-action {o.name}\n"
        f"    :parameters ()\n"
        f"    :duration {duration}\n"
        f"    :condition (and {' '.join(conditions)})\n"
        f"    :effect (and {' '.join(effects)}))"
    )
