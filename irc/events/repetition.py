"""Repetitions: what a cancelled action had, and the action that is done in its place."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from irc.model import Action, DurationRange, Group, Mode, Precedence
from irc.model.cancellation import latest
from irc.model.details import Lapsed
from irc.model.events import RetryAction
from irc.model.quantities import Number, exact
from irc.model.times import Clock


def lapsed_of(
    action: Action,
    precedence: Iterable[Precedence],
    groups: Iterable[Group],
    goals: Collection[Any],
) -> Lapsed:
    """The part of an action's order, groups and goals that lapses when it is cancelled."""
    name = action.id
    fields: dict[str, Any] = {"action": name}
    if action.occurs != "once":
        fields["occurs"] = action.occurs
    if action.deadline is not None:
        fields["deadline"] = action.deadline
    if edges := tuple(e for e in precedence if name in (e.before, e.after)):
        fields["precedence"] = edges
    if members := tuple(group for group in groups if name in group.actions):
        fields["groups"] = members
    if name in goals:
        fields["goal"] = True
    return Lapsed(**fields)


def repetition_of(
    action: Action, had: Lapsed, change: RetryAction, name: str, at: Number, clock: Clock
) -> Action:
    """The action `name` that does again from `at` on what `action` has not done.

    A fixed start that has passed binds no more. Of an action that is in part done, what its start
    needed, changed and took is not asked for again.
    """
    fields: dict[str, Any] = {f: getattr(action, f) for f in action.model_fields_set}
    fields |= {"id": name, "occurs": had.occurs, "deadline": had.deadline}
    if action.start is not None and clock.number(action.start) <= at:
        fields["start"] = None
    done = clock.number(change.done)
    if done:
        fields |= _rest(action, done, change.mode, clock)
        fields |= _left_to_come(action)
    defaults = {f: Action.model_fields[f].default for f in fields if f not in ("id", "duration")}
    return Action(**{f: v for f, v in fields.items() if f not in defaults or v != defaults[f]})


def _left_to_come(part: Action | Mode) -> dict[str, Any]:
    """The state and the stock of an action, or of its mode, without what belongs to its start."""
    return {
        "conditions": tuple(c for c in part.conditions if c.at != "start"),
        "effects": tuple(e for e in part.effects if e.at != "start"),
        "consumes": tuple(c for c in part.consumes if c.at == "end"),
        "produces": tuple(c for c in part.produces if c.at != "start"),
    }


def _rest(action: Action, done: Number, mode: str | None, clock: Clock) -> dict[str, Any]:
    """The durations of an action that has been done for a time, in a mode if it has modes."""
    if not action.modes:
        return {"duration": _shorter(action.duration, lambda d: max(0, d - done), clock)}
    own = next(m.duration for m in action.modes if m.id == mode)
    whole = clock.number(own.max if isinstance(own, DurationRange) else own)
    left = max(Fraction(0), 1 - Fraction(done) / whole) if whole else Fraction(0)
    modes = tuple(
        m.model_copy(
            update={
                "duration": _shorter(m.duration, lambda d: d * left, clock),
                **{f: v for f, v in _left_to_come(m).items() if f in m.model_fields_set},
            }
        )
        for m in action.modes
    )
    return {"modes": modes}


def _shorter(duration: Any, change: Callable[[Number], Number], clock: Clock) -> Any:
    def number(value: Any) -> Number:
        return clock.number(exact(Fraction(change(clock.number(value)))))

    if isinstance(duration, DurationRange):
        return DurationRange(min=number(duration.min), max=number(duration.max))
    return number(duration)


class Restored(NamedTuple):
    """The precedences that a repetition takes over from the cancelled action."""

    precedence: tuple[Precedence, ...]
    """Precedences whose other action can still happen or has happened."""
    waiting: Mapping[str, tuple[Precedence, ...]]
    """Precedences for each cancelled action that has not been repeated."""


def restored(
    had: Lapsed, name: str, lapsed: Mapping[str, Lapsed], over: Callable[[str], bool]
) -> Restored:
    """The precedences of a cancelled action, with the repetition `name` in its place."""
    kept: list[Precedence] = []
    waiting: dict[str, list[Precedence]] = {}
    for edge in had.precedence:
        ends = {"before": edge.before, "after": edge.after}
        side = "before" if edge.before == had.action else "after"
        other = "after" if side == "before" else "before"
        ends[side], ends[other] = name, latest(ends[other], lapsed)
        new = edge.model_copy(update=ends)
        if over(ends[other]):
            waiting.setdefault(ends[other], []).append(new)
        elif new not in kept:
            kept.append(new)
    return Restored(tuple(kept), {name: tuple(edges) for name, edges in waiting.items()})
