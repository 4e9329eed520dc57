"""Rules about several activities: groups, coupled choices, selections, orders of uses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from irc.diagnostics.source import Pointer


@dataclass(frozen=True, slots=True)
class Group:
    """All of its members (activities) or none; a required one is always there."""

    id: str
    members: tuple[int, ...]
    required: bool = True
    reward: int = 0
    due: int | None = None
    weight: int = 1
    origin: Pointer = ()


class CoupledChoice(NamedTuple):
    """The choices of an activity that a coupling is about.

    `use` is the place of one of the action's own uses in the source; None: all that it holds.
    `modes` (names, of which one) and `resource` (index) are what an "if" or a "then" says.
    """

    activity: int
    use: int | None = None
    modes: tuple[str, ...] = ()
    resource: int | None = None


class Coupling(NamedTuple):
    """Choices that depend on each other, among present activities.

    `kind` is "same", "different" or "if" (of two members), `what` is "resource" or "mode".
    """

    kind: str
    what: str
    members: tuple[CoupledChoice, ...]
    origin: int = 0

    @property
    def is_about_resources(self) -> bool:
        """Whether it is about what its members hold, not only about their modes."""
        return self.what == "resource" or any(m.resource is not None for m in self.members)


class Selection(NamedTuple):
    """At least `least` and at most `most` (None: all) of the items are present.

    An item is a set of activities that are present together; with a `condition`, which is an item,
    only where that is present. With `all_or_none` it is all of them or none instead.
    """

    items: tuple[tuple[int, ...], ...]
    least: int
    most: int | None
    condition: tuple[int, ...] | None = None
    origin: int = 0
    all_or_none: bool = False


NOBODY = -1
"""In a row of a sequence: no activity of the job holds that resource."""


class UseOrder(NamedTuple):
    """An order of uses of resources of capacity 1, which all have `setups`, perhaps empty ones.

    `kind` is "consecutive" (the one row has two activities, of which the second holds each of the
    `resources` next after the first, if both hold it) or "same_order" (a row for each job, with its
    activity on each resource, or `NOBODY`). Nothing is demanded of the pairs of rows (indexes) that
    are `waived`: while a task runs, their order is history.
    """

    kind: str
    resources: tuple[int, ...]
    rows: tuple[tuple[int, ...], ...]
    origin: int = 0
    waived: tuple[tuple[int, int], ...] = ()
