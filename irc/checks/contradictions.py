"""What contradicts itself about state: an action's own conditions or effects, or two goals.

Only what every schedule contains is told: a contradiction in an optional action keeps that action
out, and nothing else.
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
    """Adds what no schedule can satisfy whatever else it contains."""
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
            else 'keep one of the two, or let the other be "at" the other end',
        )


def _check_conditions(task: Task, activity: Activity, findings: Findings) -> None:
    """Two values required of one variable at one instant.

    What holds throughout holds until the end conditions are looked at, so these must agree too;
    what takes no time has one instant.
    """
    places = fact_places(task, activity, "conditions")
    told: set[Pointer] = set()
    instants = (("start", "all", "end"),) if activity.duration_max == 0 else _INSTANTS
    for instant in instants:
        chosen = [place for place in places if place.at in instant]
        for first, second in _clashes(chosen, lambda f: ""):
            told.add(second.pointer)
            _tell_conditions(activity, first, second, findings)
    if activity.duration_min > 0:
        unlike = [f for f in places if f.at == "all" and f.pointer not in told]
        _check_beginning(task, activity, unlike, findings)


_INSTANTS = (("start",), ("all", "end"))


def _check_beginning(
    task: Task, activity: Activity, throughout: Sequence[ShownFact], findings: Findings
) -> None:
    """What must hold right after the start, against what the start leaves.

    At an instant at which an action reads or changes a variable nothing else can change it.
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
            _tell_conditions(activity, begins, fact, findings)


def _tell_conditions(
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
