"""Random tasks whose durations and lags are far apart, and whose other times lie in between."""

from __future__ import annotations

import random
from typing import Any

from irc.model import Task
from oracles.online_random import online_task

Document = dict[str, Any]


def coarse_task(rng: random.Random, step: int = 6) -> Task:
    """A small task with durations and lags that are multiples of `step`; others are anything."""
    document = online_task(rng).model_dump(mode="json", by_alias=True, exclude_unset=True)

    def anywhere(time: int) -> int:
        return time * step + rng.choice([0, 0, rng.randrange(step)])

    def later(time: int) -> int:
        return (time + 1) * step + rng.randrange(step)

    for action in document["actions"]:
        for part in (action, *action.get("modes", [])):
            _scale(part, "duration", step)
        for field in {"release", "start", "due"} & action.keys():
            action[field] = anywhere(action[field])
        for field in ("deadline", "latest_start", "earliest_end"):
            if field in action:
                action[field] = later(action[field])
    for order in document.get("precedence", []):
        for field in {"min_lag", "max_lag"} & order.keys():
            order[field] *= step
    for part in (document, *document.get("groups", [])):
        if "deadline" in part:
            part["deadline"] = later(part["deadline"])
    for resource in document.get("resources", []):
        for window in resource.get("availability", [])[:1]:
            window["from"], window["to"] = anywhere(window["from"]), later(window["to"])
            resource["availability"] = [window]
    return Task.model_validate(document)


def _scale(part: Document, field: str, step: int) -> None:
    value = part.get(field)
    if isinstance(value, dict):
        part[field] = {name: bound * step for name, bound in value.items()}
    elif value is not None:
        part[field] = value * step
