"""Checks for contradictions about state: in one action's conditions or effects, or in two goals.

Only contradictions that every schedule contains are reported: one in an optional action only keeps
that action out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from irc.checks.facts import ShownFact, fact_places, goal_places
from irc.diagnostics import Code, Findings
from irc.diagnostics.source import Pointer
from irc.model import Task
from irc.model.state_values import value_text
from irc.problem import Activity, Problem


def check_contradictions(
    task: Task, problem: Problem, required: frozenset[int], findings: Findings
) -> None:
    """Adds conditions, effects and goals that no schedule can satisfy together."""
    for i in sorted(required):
        activity = problem.activities[i]
        if activity.details.effects:
            _check_effects(task, activity, findings)
        if activity.details.conditions:
            _check_conditions(task, activity, findings)
    _check_goals(task, findings)


def _check_effects(task: Task, activity: Activity, findings: Findings) -> None:
    """Two values given to one variable at one happening (docs/semantics.md, rule 6)."""
    places = fact_places(task, activity, "effects")
    # An action that takes no time has one happening, at which all its effects apply.
    whole = activity.duration_max == 0
    for first, second in _clashes(places, lambda f: "at once" if whole else f.at):
        when = "its only instant" if whole else f"its {second.at}"
        findings.add(
            Code.AT_ODDS,
            f"action {activity.id!r} gives {first.var!r} two values at {when}: "
            f"{value_text(first.value)} and {value_text(second.value)}",
            second.pointer,
            hint="keep one of the two effects"
            if whole
            else 'keep one of the two, or change the "at" of the other',
        )


def _check_conditions(task: Task, activity: Activity, findings: Findings) -> None:
    """Adds pairs of conditions that ask for two values of one variable at one instant.

    A condition that holds throughout also holds where the end conditions are checked, so these
    must agree too; an action that takes no time has one instant.
    """
    places = fact_places(task, activity, "conditions")
    reported: set[Pointer] = set()
    instants = (("start", "all", "end"),) if activity.duration_max == 0 else _INSTANTS
    for instant in instants:
        chosen = [place for place in places if place.at in instant]
        for first, second in _clashes(chosen, lambda f: ""):
            reported.add(second.pointer)
            _report_conditions(activity, first, second, findings)
    if activity.duration_min > 0:
        unlike = [f for f in places if f.at == "all" and f.pointer not in reported]
        _check_beginning(task, activity, unlike, findings)


_INSTANTS = (("start",), ("all", "end"))


def _check_beginning(
    task: Task, activity: Activity, throughout: Sequence[ShownFact], findings: Findings
) -> None:
    """Compares conditions that hold throughout with the values that the start leaves.

    At an instant at which an action reads or changes a variable, no other action can change it.
    """
    given = {f.var: f for f in fact_places(task, activity, "effects") if f.at == "start"}
    required = {f.var: f for f in fact_places(task, activity, "conditions") if f.at == "start"}
    for fact in throughout:
        effect, begins = given.get(fact.var), required.get(fact.var)
        if effect is not None and effect.key != fact.key:
            findings.add(
                Code.AT_ODDS,
                f"action {activity.id!r} needs {fact.var!r} to be {value_text(fact.value)} "
                f"throughout, but makes it {value_text(effect.value)} itself at its start",
                fact.pointer,
                hint='let the condition be "at": "start", or correct one of the two values',
            )
        elif effect is None and begins is not None and begins.key != fact.key:
            _report_conditions(activity, begins, fact, findings)


def _report_conditions(
    activity: Activity, first: ShownFact, second: ShownFact, findings: Findings
) -> None:
    findings.add(
        Code.AT_ODDS,
        f"action {activity.id!r} needs {first.var!r} to be {value_text(first.value)} "
        f"{_WHEN[first.at]} and {value_text(second.value)} {_WHEN[second.at]}",
        second.pointer,
        hint="keep one of the two conditions, or correct one of them",
    )


_WHEN = {"start": "at its start", "all": "throughout", "end": "at its end"}


def _check_goals(task: Task, findings: Findings) -> None:
    for first, second in _clashes(goal_places(task), lambda f: ""):
        findings.add(
            Code.AT_ODDS,
            f"the goals ask for two values of {first.var!r}: "
            f"{value_text(first.value)} and {value_text(second.value)}",
            second.pointer,
            hint="keep one of the two goals",
        )


def _clashes(
    facts: Iterable[ShownFact], instant: Callable[[ShownFact], str]
) -> Iterator[tuple[ShownFact, ShownFact]]:
    """The first fact of each variable and instant, with each later one that differs from it."""
    first: dict[tuple[str, str], ShownFact] = {}
    for fact in facts:
        earlier = first.setdefault((fact.var, instant(fact)), fact)
        if earlier.key != fact.key:
            yield earlier, fact
