"""Builds the IR task of ground actions.

A fact that some action changes is a boolean state variable; the value of every other fact is known
already. A fact that nothing reads and no action both adds and deletes is left out, because it
changes no schedule.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from irc.errors import IrcError
from irc.frontends.importers.instances import without_empty
from irc.frontends.importers.pddl.ground import Atom, Ground, atom_text
from irc.frontends.importers.pddl.lifted import Fact, Lifted
from irc.model import Task
from irc.model.quantities import exact
from irc.model.times import json_number

EVENT = "at "
"""The beginning of the ids of timed initial literals; those of PDDL's actions begin with '('."""

Raw = dict[str, Any]


class UnreachableError(IrcError, ValueError):
    """A goal that no plan can reach; `fact` is its fact."""

    def __init__(self, message: str, fact: Fact) -> None:
        super().__init__(message)
        self.fact = fact


def pddl_task(lifted: Lifted, actions: Sequence[Ground]) -> Task:
    """The IR task. Raises `UnreachableError`."""
    builder = _Builder(lifted, tuple(actions))
    goals = list(builder.goals())
    return Task.model_validate(
        without_empty(
            {
                "name": lifted.problem,
                "metadata": builder.metadata(),
                "state": builder.state(),
                "actions": [*builder.events(), *map(builder.action, builder.useful)],
                "goals": goals,
            }
        )
    )


@dataclass(frozen=True)
class _Builder:
    lifted: Lifted
    actions: tuple[Ground, ...]

    @cached_property
    def written(self) -> dict[Fact, set[bool]]:
        """The values that effects give to each fact."""
        values: dict[Fact, set[bool]] = {}
        for fact, value in self._all_effects():
            values.setdefault(fact, set()).add(value)
        return values

    def _all_effects(self) -> Iterator[Atom]:
        for action in self.actions:
            yield from (atom for _, atom in action.effects)
        yield from ((fact, value) for _, fact, value in self.lifted.timed)

    @cached_property
    def kept(self) -> dict[Fact, None]:
        """The facts that are state variables, in the order of their first use."""
        read = {fact for action in self.actions for _, (fact, _) in action.conditions}
        read |= {fact for fact, _ in self.lifted.goal}
        return {
            fact: None
            for fact, _ in self._all_effects()
            if fact in read or len(self.written[fact]) > 1
        }

    @cached_property
    def useful(self) -> list[Ground]:
        """The actions that change a state variable."""
        return [action for action in self.actions if self._matters(action)]

    def _matters(self, action: Ground) -> bool:
        return any(fact in self.kept for _, (fact, _) in action.effects)

    def state(self) -> list[Raw]:
        initial = self.lifted.initial
        return [
            {"id": atom_text(fact), **({"initial": True} if fact in initial else {})}
            for fact in self.kept
        ]

    def action(self, action: Ground) -> Raw:
        made: Raw = {
            "id": action.text,
            "duration": _duration(action.shortest, action.longest),
            "occurs": "optional" if self._happens_once(action) else {"min": 0},
            "conditions": self._atoms(action.conditions),
            "effects": self._atoms(action.effects),
        }
        return without_empty(made)

    def _atoms(self, atoms: Iterable[tuple[str, Atom]]) -> list[Raw]:
        return [
            {"at": when, "var": atom_text(fact), **({} if value else {"value": False})}
            for when, (fact, value) in atoms
            if fact in self.kept
        ]

    def _happens_once(self, action: Ground) -> bool:
        """Whether an action deletes a condition of its own for good, so that it can happen once."""
        undone = {(fact, not value) for _, (fact, value) in action.effects}
        return any(
            atom in undone and atom[1] not in self.written.get(atom[0], set())
            for _, atom in action.conditions
        )

    def events(self) -> list[Raw]:
        """The actions of timed initial literals, one for all literals of the same time."""
        times: dict[Fraction, dict[Fact, bool]] = {}
        for time, fact, value in self.lifted.timed:
            if fact in self.kept:
                happening = times.setdefault(time, {})
                happening[fact] = happening.get(fact, False) or value
        return [
            {
                "id": f"{EVENT}{json_number(exact(time))}",
                "duration": 0,
                "start": exact(time),
                "effects": self._atoms(("start", atom) for atom in happening.items()),
            }
            for time, happening in sorted(times.items())
        ]

    def goals(self) -> Iterator[Raw]:
        for fact, value in self.lifted.goal:
            text = atom_text(fact) if value else f"(not {atom_text(fact)})"
            if value not in self.written.get(fact, set()) and (
                (fact in self.lifted.initial) != value
            ):
                raise UnreachableError(
                    f"the goal {text} can never hold: it does not hold at first, and no action"
                    " that can happen brings it about",
                    fact,
                )
            if fact in self.kept:
                yield {"var": atom_text(fact), **({} if value else {"value": False})}

    def metadata(self) -> Raw:
        useless = [action.text for action in self.actions if not self._matters(action)]
        return {
            "pddl": {"domain": self.lifted.domain, "problem": self.lifted.problem},
            **({"actions_that_change_nothing_that_matters": useless} if useless else {}),
        }


def _duration(shortest: Fraction, longest: Fraction) -> Any:
    if shortest == longest:
        return exact(shortest)
    return {"min": exact(shortest), "max": exact(longest)}
