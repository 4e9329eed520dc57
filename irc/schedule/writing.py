"""Writes schedules as documents, and documents as JSON text."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from json.encoder import encode_basestring
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from irc.model.garbage import without_garbage
from irc.model.times import json_number
from irc.schedule.entry import Entry, LeftOut

if TYPE_CHECKING:
    from irc.schedule.schedule import Schedule

SCHEDULE_VERSION = "1"


def document(schedule: Schedule) -> dict[str, Any]:
    """The document that `irc solve --format json` writes."""
    dated = schedule.has_dates
    return _with_entries(schedule, [_entry_json(entry, dated) for entry in schedule.entries])


@without_garbage()
def schedule_text(schedule: Schedule) -> str:
    """The text of the document as the project writes files: `dump_json` of it, at less cost."""
    if schedule.has_dates:
        return dump_json(document(schedule))
    texts = {key: _lines(value) for key, value in _with_entries(schedule, []).items()}
    if schedule.entries:
        texts["actions"] = _listed(_entry_texts(schedule.entries))
    return _joined(texts)


def _with_entries(schedule: Schedule, entries: list[Any]) -> dict[str, Any]:
    """The document of a schedule, given those of its entries."""
    dated = schedule.has_dates
    return {
        "irc_schedule": SCHEDULE_VERSION,
        "task": schedule.task,
        "task_sha256": schedule.task_sha256,
        **({} if schedule.time_unit is None else {"time_unit": schedule.time_unit}),
        **(schedule.dates.to_dict() if schedule.dates is not None and dated else {}),
        "status": str(schedule.status),
        **({"interrupted": True} if schedule.interrupted else {}),
        **({} if schedule.repeatable is None else {"repeatable": schedule.repeatable}),
        "makespan": json_number(schedule.makespan) if schedule.answered else None,
        "objective": [
            {
                "name": o.name,
                "value": json_number(o.value),
                "bound": None if o.bound is None else json_number(o.bound),
            }
            for o in schedule.objective
        ],
        "actions": entries,
        **({"left_out": list(map(_left_out_json, schedule.left_out))} if schedule.left_out else {}),
        "target": schedule.target,
        "engine": schedule.engine,
        "seconds": schedule.seconds,
        **({} if schedule.answered else {"outcome": schedule.outcome.to_dict()}),
    }


_AT_ONCE = 2_000
"""Entries whose texts are made at once: so few that they stay in the processor's cache."""

_BESIDES_TIMES: Mapping[str, object] = {
    "mode": None,
    "occurrence": 1,
    "rank": 0,
    "end_rank": None,
    "paused": 0,
    "status": None,
}
_besides_times = attrgetter(*_BESIDES_TIMES)
_times = attrgetter("id", "start", "end")


def _entry_texts(entries: Sequence[Entry]) -> Iterator[str]:
    """The JSON texts of entries without dates; most have only an id and whole times."""
    for at in range(0, len(entries), _AT_ONCE):
        some = entries[at : at + _AT_ONCE]
        names, starts, ends = zip(*map(_times, some), strict=True)
        if (
            any(entry.resources for entry in some)
            or set(map(_besides_times, some)) != {(*_BESIDES_TIMES.values(),)}
            or {*map(type, starts), *map(type, ends)} != {int}
        ):
            yield from (_encode(_entry_json(entry, False)) for entry in some)
            continue
        for name, start, end in zip(map(encode_basestring, names), starts, ends, strict=True):
            yield f'{{"id": {name}, "start": {start}, "end": {end}}}'


def _left_out_json(what: LeftOut) -> str | dict[str, Any]:
    return what if isinstance(what, str) else {"var": what[0], "value": what[1]}


def _entry_json(entry: Entry, dated: bool) -> dict[str, Any]:
    shown: dict[str, Any] = {
        "id": entry.id,
        "start": json_number(entry.start),
        "end": json_number(entry.end),
    }
    if dated and (dates := entry.dates) is not None:
        shown |= {"start_at": dates.text(entry.start), "end_at": dates.text(entry.end)}
    if entry.occurrence != 1:
        shown["occurrence"] = entry.occurrence
    if entry.mode is not None:
        shown["mode"] = entry.mode
    if entry.resources:
        shown["resources"] = dict(sorted(entry.resources.items()))
    if entry.rank:
        shown["rank"] = entry.rank
    if entry.end_rank is not None and entry.end_rank != entry.rank:
        shown["end_rank"] = entry.end_rank
    if entry.paused:
        shown["paused"] = json_number(entry.paused)
    if entry.status is not None:
        shown["status"] = entry.status
    return shown


def dump_json(document: Mapping[str, Any]) -> str:
    """JSON text as the project writes files: a line for each field and for each list entry."""
    return _joined({key: _lines(value) for key, value in document.items()})


def _joined(texts: Mapping[str, str]) -> str:
    """The text of a document, given those of its fields."""
    fields = [f"  {json.dumps(key)}: {text}" for key, text in texts.items()]
    return "{\n" + ",\n".join(fields) + "\n}\n"


_encode = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode


def _lines(value: Any) -> str:
    if not isinstance(value, list) or not value or not isinstance(value[0], dict):
        return _encode(value)
    return _listed(map(_encode, value))


def _listed(texts: Iterable[str]) -> str:
    return "[\n    " + ",\n    ".join(texts) + "\n  ]"
