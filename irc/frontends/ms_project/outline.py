"""The outline of a project: its tasks, the summary tasks above them, and what is left out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from irc.frontends.ms_project.elements import Element

_DEEPEST = 100


@dataclass(eq=False)
class Item:
    """A task of the project. One with parts is a summary task, which is no action."""

    element: Element
    uid: int
    name: str
    id: str
    level: int
    parent: Item | None = None
    parts: list[Item] = field(default_factory=list)

    @property
    def is_summary(self) -> bool:
        """Whether it only sums up its parts."""
        return bool(self.parts)

    def leaves(self) -> Iterator[Item]:
        """The tasks under it that are carried out; itself, if it is one."""
        if not self.parts:
            yield self
        for part in self.parts:
            yield from part.leaves()

    def path(self) -> list[str]:
        """The names of the summary tasks above it, the uppermost first."""
        return [*self.parent.path(), self.parent.name] if self.parent else []


@dataclass(frozen=True)
class Outline:
    """The tasks by UID, in the order of the project, and the UIDs of inactive ones."""

    items: dict[int, Item]
    inactive: frozenset[int]

    @property
    def leaves(self) -> list[Item]:
        """The tasks that are carried out."""
        return [item for item in self.items.values() if not item.is_summary]


class Ids:
    """Gives each element an id of its own, from its name where that is possible."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def take(self, name: str, otherwise: str) -> str:
        """The name, the name with `otherwise` in parentheses, or with a number, too."""
        wanted = name or otherwise
        found, count = wanted, 1
        while found in self._taken:
            found = f"{wanted} ({otherwise})" if count == 1 else f"{wanted} ({otherwise}, {count})"
            count += 1
        self._taken.add(found)
        return found


def read_outline(project: Element, ids: Ids) -> Outline:
    """The tasks of a project. Parts of other projects, and UIDs given twice, are faults."""
    items: dict[int, Item] = {}
    inactive: set[int] = set()
    above: list[Item] = []
    for one in project.all("Tasks", "Task"):
        if one.flag("IsNull"):
            continue
        level, uid = one.whole("OutlineLevel", 1), one.whole("UID", -1)
        if not _is_readable(one, uid, level, items):
            continue
        while above and above[-1].level >= level:
            above.pop()
        name, parent = one.said("Name"), above[-1] if above else None
        item = Item(one, uid, name, "", level, parent)
        if level > 0:  # Level 0 is the project itself.
            above.append(item)
            items[uid] = item
            if not one.flag("Active", True):
                inactive.add(uid)
            elif parent is not None:
                parent.parts.append(item)
    kept = _without_inactive(items, inactive)
    for item in sorted(kept.values(), key=lambda item: item.is_summary):
        label = item.element.said("ID") or str(item.uid)
        item.name = item.name or f"task {label}"
        item.id = ids.take(item.element.said("Name"), f"task {label}")
    return Outline(kept, frozenset(items.keys() - kept.keys()))


def _is_readable(one: Element, uid: int, level: int, items: dict[int, Item]) -> bool:
    name = one.said("Name")
    if uid < 0 or uid in items:
        message = "needs a UID" if uid < 0 else f"has the UID {uid} of another task"
        one.faults.add(one.at("UID"), f"task {name!r} {message}")
        return False
    if not 0 <= level <= _DEEPEST:
        one.faults.add(one.at("OutlineLevel"), f"OutlineLevel: expected 0 to {_DEEPEST}")
        return False
    if one.flag("ExternalTask") or one.said("SubprojectName"):
        message = f"task {name!r} belongs to another project, which is not read"
        one.faults.add(one, message, "insert the other project, or remove the task")
    return True


def _without_inactive(items: dict[int, Item], inactive: set[int]) -> dict[int, Item]:
    """The items of which neither they nor a summary task above them is inactive."""

    def is_active(item: Item | None) -> bool:
        return item is None or (item.uid not in inactive and is_active(item.parent))

    kept = {uid: item for uid, item in items.items() if is_active(item)}
    dropped = [item for uid, item in items.items() if uid not in kept]
    if dropped:
        shown = ", ".join(repr(item.name) for item in dropped[:5])
        more = f" and {len(dropped) - 5} more" if len(dropped) > 5 else ""
        message = f"inactive tasks and their links are left out: {shown}{more}"
        dropped[0].element.faults.warn(dropped[0].element.at("Active"), message)
    return _without_empty(kept, {item.uid for item in dropped})


def _without_empty(kept: dict[int, Item], dropped: set[int]) -> dict[int, Item]:
    """The items without summary tasks of which all parts are inactive."""
    empty = {
        uid
        for uid, item in kept.items()
        if not item.parts and item.element.flag("Summary") and dropped
    }
    if not empty:
        return kept
    for uid in empty:
        parent = kept[uid].parent
        if parent is not None:
            parent.parts.remove(kept[uid])
    rest = {uid: item for uid, item in kept.items() if uid not in empty}
    return _without_empty(rest, dropped)
