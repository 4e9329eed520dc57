"""An encoding with the meaning of its names, and both as they stand in the manifest."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from irc_pddl21.encoding.pddl import Encoding


class Meaning(NamedTuple):
    """The meaning of an operator: an action, its mode, the pool of each use."""

    action: str
    mode: str | None = None
    uses: tuple[tuple[int, str], ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """As it stands in the manifest."""
        shown: dict[str, Any] = {"action": self.action}
        if self.mode is not None:
            shown["mode"] = self.mode
        if self.uses:
            shown["uses"] = {str(use): resource for use, resource in self.uses}
        return shown


@dataclass
class Grounded:
    """An encoding with the meaning of its names."""

    encoding: Encoding
    scale: int
    slack: int
    actions: dict[str, Meaning] = field(default_factory=dict)
    planner_only: dict[str, str] = field(default_factory=dict)
    tokens: dict[str, str] = field(default_factory=dict)
    state: dict[str, str] = field(default_factory=dict)
    beyond: tuple[str, ...] = ()
    """Objectives that the metric of the text does not contain."""
    shortened: bool = False


_FACTS = {
    "todo_*": "the action has not started",
    "begun_*": "the action has started",
    "done_*": "the action has ended",
    "lag_*": "the minimum lag after that point is over",
    "after_*, during_*": "the envelope of a maximum lag has begun, still runs",
    "free_*": "this unit of the resource is free",
    "open_*, released_*": "the time window is not closed yet, has opened",
}
_FURTHER_FACTS = {
    "is_*": "the state variable has the value",
    "here_*": "this unit of the resource is not away",
    "idle_*": "no occurrence of the action is running",
}


def names_of(grounded: Grounded) -> dict[str, Any]:
    """The part of the manifest that decoding needs."""
    facts = grounded.encoding.facts
    names: dict[str, Any] = {
        "planner_units_per_tick": grounded.scale,
        "slack": grounded.slack,
        "actions": {name: meaning.to_dict() for name, meaning in grounded.actions.items()},
        "planner_only": grounded.planner_only,
        "tokens": grounded.tokens,
        "facts": {
            **_FACTS,
            **{
                pattern: meaning
                for pattern, meaning in _FURTHER_FACTS.items()
                if any(fact.startswith(pattern[:-1]) for fact in facts)
            },
        },
    }
    if grounded.state:
        names["state"] = grounded.state
    if grounded.shortened:
        names["shortened"] = True
    if grounded.beyond:
        names["objectives_beyond_the_metric"] = list(grounded.beyond)
    return names
