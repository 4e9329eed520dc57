"""Reads a plan of an original PDDL problem as a schedule of the imported task.

Taken are plan files, the output of planners (the last plan of the text counts) and
unified-planning's print: `0.000: (move ann den hall) [5.000]`, `0.0: move(ann, den, hall) [5.0]`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from irc.diagnostics import Code, Findings, InputError, Report, did_you_mean
from irc.diagnostics.source import Source
from irc.model import Action, Condition, Effect, Task
from irc.model.original import OriginalStep
from irc.model.quantities import exact
from irc.schedule import Entry, Schedule

_NUMBER = r"\d{1,30}(?:\.\d{0,30})?"
_STEP = re.compile(
    rf"^[ \t]*(?P<start>{_NUMBER})[ \t]*:[ \t]*"
    r"(?:\((?P<words>[^()\n;]{1,4000})\)|(?P<name>[\w-]{1,400})(?:\((?P<args>[^()\n]{0,4000})\))?)"
    rf"[ \t]*(?:\[[ \t]*(?P<lasts>{_NUMBER})[ \t]*\])?[ \t]*(?:;.*)?$",
    re.MULTILINE,
)
_VARIANT = re.compile(r" #\d+\Z")
_HINT = "expected lines such as 0.000: (move ann den hall) [5.000]"


def is_from_pddl(task: Task) -> bool:
    """Whether a task was imported from PDDL."""
    return "pddl" in task.metadata


@dataclass(frozen=True)
class _Step:
    name: str
    start: Fraction
    lasts: Fraction
    offset: int


def read_plan(text: str, name: str, task: Task) -> Schedule:
    """The schedule of a plan, with the plan's own times.

    Steps that change nothing that matters are left out. Raises `InputError` where there is no plan,
    or it has an action that the task does not have.
    """
    findings = Findings()
    steps = list(_last_plan(_steps(text)))
    if not steps and not re.search(r"found|plan", text, re.IGNORECASE):
        findings.add(Code.BAD_ANSWER, "there is no plan in the text", offset=0, hint=_HINT)
    chosen = _actions(task, steps, findings)
    if findings.items:
        raise InputError(Report(tuple(findings.items), Source(name, text)))
    return Schedule(tuple(_numbered(task, chosen)))


def _actions(task: Task, steps: list[_Step], findings: Findings) -> list[tuple[_Step, str]]:
    """The steps that matter, each with the id of its action."""
    ways: dict[str, list[Action]] = {}
    for action in task.actions:
        ways.setdefault(_VARIANT.sub("", action.id), []).append(action)
    left_out = task.metadata.get("actions_that_change_nothing_that_matters", ())
    useless = {_VARIANT.sub("", str(other)) for other in left_out}
    for equal in task.metadata.get("pddl", {}).get("interchangeable", ()):
        steps = _matched(steps, equal["objects"], equal["in_the_order_of"])
    known: list[_Step] = []
    for step in steps:
        if step.name in ways:
            known.append(step)
        elif step.name not in useless:
            message = f"the task has no action {step.name!r} that could ever happen"
            hint = did_you_mean(step.name, ways)
            findings.add(Code.BAD_ANSWER, message, offset=step.offset, hint=hint)
    return [] if findings.items else list(_chosen(task, known, ways))


def original_steps(task: Task, steps: Iterable[OriginalStep]) -> list[OriginalStep]:
    """The steps of a plan of the original that are actions of the task, with their ids.

    Raises `InputError` like `read_plan`.
    """
    given = [_Step(s.action.lower(), s.start, s.end - s.start, 0) for s in steps]
    findings = Findings()
    chosen = _actions(task, given, findings)
    if findings.items:
        raise InputError(Report(tuple(findings.items)))
    return [OriginalStep(id, step.start, step.start + step.lasts) for step, id in chosen]


def _steps(text: str) -> Iterator[_Step]:
    for found in _STEP.finditer(text):
        words = found["words"]
        if words is None:
            words = f"{found['name']} {(found['args'] or '').replace(',', ' ')}"
        yield _Step(
            f"({' '.join(words.lower().split())})",
            Fraction(found["start"]),
            Fraction(found["lasts"] or 0),
            found.start("start"),
        )


def _last_plan(steps: Iterable[_Step]) -> list[_Step]:
    """The steps of the last plan: a step that goes back in time to 0 begins another one."""
    plan: list[_Step] = []
    for step in steps:
        if plan and step.start < plan[-1].start and step.start <= plan[0].start:
            plan = []
        plan.append(step)
    return plan


def _matched(steps: list[_Step], objects: list[str], order: list[str]) -> list[_Step]:
    """The steps with interchangeable objects renamed, as the task matches them with actions."""
    place = {_VARIANT.sub("", name): k for k, name in reversed(list(enumerate(order)))}
    used: list[tuple[int, Fraction, str]] = []
    for step in steps:
        name, *words = step.name[1:-1].split()
        for item in objects:
            if item in words:
                open_name = f"({' '.join((name, *('*' if w == item else w for w in words)))})"
                used.append((place.get(open_name, len(place)), step.start, item))
    names = dict(zip(dict.fromkeys(item for _, _, item in sorted(used)), objects, strict=False))
    return [replace(step, name=_renamed(step.name, names)) for step in steps]


def _renamed(step: str, names: Mapping[str, str]) -> str:
    """The step with other objects; an action may have the name of one."""
    name, *words = step[1:-1].split()
    return f"({' '.join((name, *(names.get(word, word) for word in words)))})"


def _chosen(
    task: Task, steps: list[_Step], ways: Mapping[str, list[Action]]
) -> Iterator[tuple[_Step, str]]:
    """Each step with the id of its action, the variant whose conditions hold where there are some.

    The happenings are gone through in order; at one time ends come first.
    """
    values: dict[str, object] = {variable.id: variable.start_value for variable in task.state}
    points: list[tuple[Fraction, int, int]] = []
    for k, step in enumerate(steps):
        points += [(step.start, 2, k), (step.start + step.lasts, 0 if step.lasts else 3, k)]
    changes = list(_changes(task))
    points += [(change[0], 1, k) for k, change in enumerate(changes)]
    left = [list(ways[step.name]) for step in steps]
    for _, stage, k in sorted(points):
        if stage == 1:
            values[changes[k][1]] = changes[k][2]
            continue
        when = "start" if stage == 2 else "end"
        left[k] = [a for a in left[k] if _holds(a, when, values)] or left[k][:1]
        for effect in left[k][0].effects:
            if effect.at == when:
                values[effect.var] = _after(values[effect.var], effect)
    for step, actions in zip(steps, left, strict=True):
        yield step, actions[0].id


def _after(value: object, effect: Effect) -> object:
    """The value of a variable after an effect on it."""
    if effect.add is not None and isinstance(value, (int, Fraction)):
        return value + effect.add
    return effect.value if effect.set is None else effect.set


def _changes(task: Task) -> Iterator[tuple[Fraction, str, object]]:
    for variable in task.state:
        for change in variable.changes:
            yield Fraction(task.number(change.at)), variable.id, change.value


def _holds(action: Action, when: str, values: Mapping[str, object]) -> bool:
    return all(_is_met(values[c.var], c) for c in action.conditions if c.at == when)


def _is_met(value: object, condition: Condition) -> bool:
    if not condition.asks_for_a_level:
        return value == condition.value
    least, greatest = condition.limits
    return isinstance(value, (int, Fraction)) and (
        (least is None or value >= least) and (greatest is None or value <= greatest)
    )


def _numbered(task: Task, steps: Iterable[tuple[_Step, str]]) -> Iterator[Entry]:
    held = {
        action.id: {use.resource: use.amount for use in action.uses if use.resource is not None}
        for action in task.actions
        if action.uses
    }
    count: dict[str, int] = {}
    for step, id in sorted(steps, key=lambda pair: pair[0].start):
        count[id] = count.get(id, 0) + 1
        start, end = exact(step.start), exact(step.start + step.lasts)
        yield Entry(id, start, end, held.get(id, {}), occurrence=count[id])
