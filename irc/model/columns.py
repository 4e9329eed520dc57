"""A task that is kept as columns: many actions of which only the ids and durations are written.

An action as an object of pydantic takes a kilobyte, so a million of them do not fit into the memory
of a small machine. Where nothing but whole durations and precedences is written, the columns say
all, and the actions are made only for a caller that asks for them.
"""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import PrivateAttr

from irc.model.garbage import without_garbage
from irc.model.original import Original
from irc.model.task import Task
from irc.model.times import Clock, unit_seconds

MADE = ("actions", "precedence")
"""The fields that are made of the columns when they are first read."""


class Columns(NamedTuple):
    """Actions and finish-start precedences without lags, in the order of the document.

    `ids` are distinct, and have no character that JSON escapes. `durations` are whole numbers of
    time units above 0, one for each id. `before` and `after` are indexes of actions, a pair for
    each precedence; the pairs are distinct, and no action precedes itself. `following` has them by
    their first action: all that come behind it. `head` is the task without actions.
    """

    head: Task
    ids: list[str]
    durations: list[int]
    before: list[int]
    after: list[int]
    following: list[list[int]]


class ColumnTask(Task):
    """A task with the objective makespan, and with nothing but the columns besides its head.

    It equals the `Task` with the same contents in all respects. A copy of it is a `Task`.
    """

    _columns: Columns = PrivateAttr()
    _own_clock: Clock = PrivateAttr()

    @classmethod
    def of(cls, columns: Columns) -> ColumnTask:
        """The task with the columns."""
        task, head = cls.__new__(cls), columns.head
        fields = {name: value for name, value in head.__dict__.items() if name not in MADE}
        object.__setattr__(task, "__dict__", fields)
        object.__setattr__(task, "__pydantic_fields_set__", set(head.model_fields_set))
        object.__setattr__(task, "__pydantic_extra__", None)
        private = dict.fromkeys(("_source", "_clock", "_original"))
        object.__setattr__(task, "__pydantic_private__", private)
        task._columns = columns
        unit = unit_seconds(head.time_unit, head.days_per_month)
        task._own_clock = Clock(unit, head.days_per_month)
        return task

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name in MADE:
                self.__dict__.update(_made(self._columns))
                return self.__dict__[name]
            return super().__getattr__(name)

    @property
    def columns(self) -> Columns:
        """The columns."""
        return self._columns

    @property
    def clock(self) -> Clock:
        """The clock: whole numbers need no resolution."""
        return self._own_clock

    def whole(self) -> Task:
        """The same task without columns."""
        fields = {name: getattr(self, name) for name in Task.model_fields}
        made = Task.model_construct(_fields_set=set(self.model_fields_set), **fields)
        return made.with_source(self.source)

    def __eq__(self, other: object) -> bool:
        return self.whole() == (other.whole() if isinstance(other, ColumnTask) else other)

    __hash__ = None

    def with_original(self, original: Original) -> Task:
        """The task with the PDDL that it was made of, without columns."""
        return self.whole().with_original(original)

    # (All that reads the fields of a model without asking for them by name.)

    def model_copy(self, **options: Any) -> Task:  # type: ignore[override]
        """A copy of the task, without columns."""
        return self.whole().model_copy(**options)

    def model_dump(self, **options: Any) -> dict[str, Any]:
        """The fields of the task."""
        return self.whole().model_dump(**options)

    def model_dump_json(self, **options: Any) -> str:
        """The fields of the task, as JSON."""
        return self.whole().model_dump_json(**options)

    def __copy__(self) -> Task:  # type: ignore[override]
        return self.whole()

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Task:  # type: ignore[override]
        return deepcopy(self.whole(), memo)

    def __reduce_ex__(self, protocol: Any) -> Any:
        return _itself, (self.whole(),)

    def __iter__(self) -> Any:
        return iter(self.whole())

    def __repr_args__(self) -> Any:
        return self.whole().__repr_args__()


def _itself(task: Task) -> Task:
    return task


@without_garbage()
def _made(columns: Columns) -> dict[str, Any]:
    """The fields of the task that the columns stand for."""
    ids = columns.ids
    actions = [{"id": i, "duration": d} for i, d in zip(ids, columns.durations, strict=True)]
    precedence = [
        {"before": ids[b], "after": ids[a]}
        for b, a in zip(columns.before, columns.after, strict=True)
    ]
    task = Task.model_validate({"actions": actions, "precedence": precedence})
    return {name: getattr(task, name) for name in MADE}
