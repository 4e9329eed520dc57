"""Writes schedules as documents, and documents as JSON text."""

from __future__ import annotations

import json
from collections.abc import Mapping
from json.encoder import encode_basestring
from typing import TYPE_CHECKING, Any

from irc.model.times import json_number
from irc.schedule.entry import Entry, LeftOut

if TYPE_CHECKING:
    from irc.schedule.schedule import Schedule

SCHEDULE_VERSION = "1"


def document(schedule: Schedule) -> dict[str, Any]:
    """The document that `irc solve --format json` writes."""
    dated = schedule.has_dates
    return _with_entries(schedule, [_entry_json(entry, dated) for entry in schedule.entries])


def schedule_text(schedule: Schedule) -> str:
    """The text of the document as the project writes files: `dump_json` of it, at less cost."""
    if schedule.has_dates:
        return dump_json(document(schedule))
    lines = [_entry_text(entry) for entry in schedule.entries]
    return dump_json(_with_entries(schedule, lines))


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


def _entry_text(entry: Entry) -> RawJson:
    """The JSON text of an entry without dates; most have only an id and whole times."""
    if (
        type(entry.start) is int
        and type(entry.end) is int
        and entry.status is None
        and entry.mode is None
        and entry.end_rank is None
        and entry.occurrence == 1
        and not (entry.resources or entry.rank or entry.paused)
    ):
        name = encode_basestring(entry.id)
        return RawJson(f'{{"id": {name}, "start": {entry.start}, "end": {entry.end}}}')
    return RawJson(_encode(_entry_json(entry, False)))


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
    fields = [f"  {json.dumps(key)}: {_lines(value)}" for key, value in document.items()]
    return "{\n" + ",\n".join(fields) + "\n}\n"


_encode = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode


class RawJson(str):
    """A part of a document that is JSON text already."""

    __slots__ = ()


def _lines(value: Any) -> str:
    if not isinstance(value, list) or not value or not isinstance(value[0], (dict, RawJson)):
        return _encode(value)
    texts = value if isinstance(value[0], RawJson) else map(_encode, value)
    return "[\n    " + ",\n    ".join(texts) + "\n  ]"
