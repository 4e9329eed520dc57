"""Reads a folder of instance files; files that cannot be read are named, skipped and counted."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from irc.diagnostics import InputError
from irc.frontends.formats import KNOWN_SUFFIXES, load_importer
from irc.model import Task
from irc.model.canonical import written_task
from racing.instance import Instance, Lag, Way, family_of

READ = ("job-shop", "flexible-job-shop", "psplib", "rcpsp-max", "patterson")
"""The formats that are raced; a file without a known suffix is read as a job shop."""

MOST_BYTES = 64_000_000
"""Longer files are skipped."""


class NotRacedError(Exception):
    """An instance has an element that the plain models do not have."""


@dataclass
class Gathered:
    """The instances of a folder with their tasks, and why files were skipped."""

    instances: list[tuple[Instance, str]] = field(default_factory=list)
    """Each with its task as JSON of the IR."""
    skipped: list[str] = field(default_factory=list)


def gather(folder: Path, form: str | None = None) -> Gathered:
    """All instances in a folder and the folders in it, in the order of their names."""
    found = Gathered()
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and p.name[0] != "."):
        source = form or KNOWN_SUFFIXES.get(path.suffix.lower(), "job-shop")
        if source not in READ:
            found.skipped.append(f"{path}: not a format of the league ({source})")
            continue
        try:
            found.instances += _read(path, source)
        except InputError as error:
            found.skipped.append(f"{path}: {str(error).splitlines()[0]}")
        except (OSError, UnicodeDecodeError, NotRacedError) as error:
            found.skipped.append(f"{path}: {error}")
    names = [instance.name for instance, _ in found.instances]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        found.skipped.append(f"named more than once, only the first counts: {', '.join(twice)}")
        first = {instance.name: (instance, text) for instance, text in reversed(found.instances)}
        found.instances = [first[name] for name in dict.fromkeys(names)]
    return found


def _read(path: Path, source: str) -> Iterator[tuple[Instance, str]]:
    if path.stat().st_size > MOST_BYTES:
        raise NotRacedError(f"more than {MOST_BYTES:,} bytes")
    text = path.read_text("utf-8")
    for stem, task in load_importer(source)(text, path.name):
        yield instance_of(stem, task), json.dumps(written_task(task))


def instance_of(name: str, task: Task) -> Instance:
    """The instance behind an imported task. Raises `NotRacedError`."""
    renewable = [r for r in task.resources if r.kind == "renewable"]
    used_up = [r for r in task.resources if r.kind != "renewable"]
    if any(getattr(r, "setups", None) for r in task.resources):
        raise NotRacedError("it has set-ups, which the plain models do not have")
    numbers = {r.id: k for k, r in enumerate(renewable)}
    budgets = {r.id: k for k, r in enumerate(used_up)}
    jobs = [_ways(action, numbers, budgets) for action in task.actions]
    ids = [action.id for action in task.actions]
    index = {id_: i for i, id_ in enumerate(ids)}
    lags = [
        Lag(
            index[edge.before],
            index[edge.after],
            _whole(edge.min_lag),
            not edge.type.startswith("start"),
        )
        for edge in task.precedence
    ]
    capacities = [int(r.capacity) for r in renewable]
    family = family_of(jobs, lags, capacities)
    stock = [_whole(getattr(r, "initial", 0)) for r in used_up]
    return Instance(name, family, ids, jobs, lags, capacities, stock)


def _ways(action: Any, numbers: dict[str, int], budgets: dict[str, int]) -> list[Way]:
    ways = [_way(mode, mode.id, numbers, budgets) for mode in action.modes or ()]
    if ways:
        return ways
    choices = [use for use in action.uses if use.resource is None]
    if not choices:
        return [_way(action, "", numbers, budgets)]
    if len(action.uses) > 1:
        raise NotRacedError(f"action {action.id!r} has several uses with a choice")
    return [
        Way(r, _whole(action.duration), [(numbers[r], int(choices[0].amount))], [])
        for r in choices[0].alternatives
    ]


def _way(part: Any, name: str, numbers: dict[str, int], budgets: dict[str, int]) -> Way:
    holds = [(numbers[use.resource], int(use.amount)) for use in part.uses or ()]
    spends = [(budgets[c.resource], _whole(c.amount)) for c in part.consumes or ()]
    return Way(name, _whole(part.duration), holds, spends)


def _whole(time: object) -> int:
    if isinstance(time, int):
        return time
    raise NotRacedError(f"not a whole number: {time!r}")
