"""Random small tasks with calendars and work that pauses."""

from __future__ import annotations

import random
from typing import Any

from irc.model import Task

ORIGINS = (
    ("2026-03-28T04:00:00+01:00", "Europe/Berlin"),
    ("2026-10-24T06:00:00+02:00", "Europe/Berlin"),
    ("2026-06-05T00:00:00-04:00", "America/New_York"),
)
"""Moments shortly before a change of clocks, and one that is not."""

_KINDS = ("finish-start", "start-start", "finish-finish", "start-finish")


def pausing_task(seed: int) -> Task:
    """A random task of 2 to 4 actions; the same one for a seed, always."""
    return _Draw(random.Random(seed)).task()


class _Draw:
    def __init__(self, rng: random.Random) -> None:
        self.rng = rng

    def task(self) -> Task:
        rng = self.rng
        dated = rng.random() < 0.4
        raw: dict[str, Any] = {"time_unit": "h"}
        if dated:
            raw["origin"], zone = rng.choice(ORIGINS)
            raw["calendars"] = [self._dated(k, zone) for k in range(rng.randint(1, 2))]
        else:
            raw["calendars"] = [self._cyclic(k) for k in range(rng.randint(1, 2))]
        names = [c["id"] for c in raw["calendars"]]
        raw["resources"] = [self._resource(k, names) for k in range(rng.randint(1, 3))]
        count = rng.randint(2, 4)
        raw["actions"] = [self._action(k, names, raw["resources"]) for k in range(count)]
        raw["precedence"] = [
            self._arc(i, j) for j in range(count) for i in range(j) if rng.random() < 0.3
        ]
        if rng.random() < 0.3:
            raw["objective"] = ["minimize_tardiness", "minimize_makespan"]
            for action in raw["actions"]:
                action["due"] = rng.randint(2, 14)
                action["weight"] = rng.randint(1, 3)
        return Task.model_validate(raw)

    def _cyclic(self, k: int) -> dict[str, Any]:
        rng = self.rng
        every = rng.choice((4, 5, 6, 8))
        start = rng.randrange(every)
        made: dict[str, Any] = {
            "id": f"c{k}",
            "every": every,
            "open": [{"from": start, "to": (start + rng.randint(2, every - 1)) % every}],
        }
        if rng.random() < 0.3:
            at = rng.randint(0, 8)
            made["closed"] = [{"from": at, "to": at + rng.randint(1, 5)}]
        return made

    def _dated(self, k: int, zone: str) -> dict[str, Any]:
        rng = self.rng
        opened = {
            "from": f"{rng.choice((0, 6, 8, 22)):02}:00",
            "to": f"{rng.choice((1, 5, 12, 14, 17)):02}:00",
        }
        if rng.random() < 0.3:
            opened["days"] = rng.sample(("fri", "sat", "sun", "mon"), 3)
        made: dict[str, Any] = {"id": f"c{k}", "time_zone": zone, "open": [opened]}
        if rng.random() < 0.2:
            made["closed"] = [rng.choice(("2026-10-25", "2026-03-29", "2026-06-05"))]
        return made

    def _resource(self, k: int, calendars: list[str]) -> dict[str, Any]:
        rng = self.rng
        made: dict[str, Any] = {"id": f"r{k}", "capacity": rng.choice((1, 1, 2))}
        if rng.random() < 0.6:
            made["calendar"] = rng.choice(calendars)
        if rng.random() < 0.3:
            at = rng.randint(0, 8)
            capacity = rng.choice((0, 0, 1))
            made["availability"] = [
                {"from": at, "to": at + rng.randint(1, 3), "capacity": capacity}
            ]
        return made

    def _action(self, k: int, calendars: list[str], resources: list[Any]) -> dict[str, Any]:
        rng = self.rng
        made: dict[str, Any] = {"id": f"a{k}"}
        if rng.random() < 0.2:
            made["modes"] = [
                {"id": f"m{m}", "duration": self._duration(), "uses": self._uses(resources)}
                for m in range(2)
            ]
        else:
            made["duration"] = self._duration()
            made["uses"] = self._uses(resources)
        if rng.random() < 0.3:
            made["calendar"] = rng.choice(calendars)
        if rng.random() < 0.6:
            made["breaks"] = "pause"
            if rng.random() < 0.3:
                made["max_pause"] = rng.randint(0, 9)
        if rng.random() < 0.15:
            made["release"] = rng.randint(1, 8)
        if rng.random() < 0.1:
            made["latest_start"] = rng.randint(4, 15)
        if rng.random() < 0.05:
            made["start"] = rng.randint(0, 8)
        if rng.random() < 0.1:
            made["deadline"] = rng.randint(8, 20)
        return made

    def _duration(self) -> Any:
        rng = self.rng
        if rng.random() < 0.2:
            least = rng.randint(0, 3)
            return {"min": least, "max": least + rng.randint(1, 3)}
        return rng.choice((0, 1, 2, 3, 3, 4, 5, 7))

    def _uses(self, resources: list[Any]) -> list[Any]:
        rng = self.rng
        names = [r["id"] for r in resources]
        few = rng.sample(names, rng.randint(0, min(2, len(names))))
        uses: list[Any] = [{"resource": name} for name in few]
        if len(names) > 1 and rng.random() < 0.3:
            uses = [{"one_of": rng.sample(names, 2)}]
        if uses and rng.random() < 0.15:
            uses[0]["amount"] = 2
        return uses

    def _arc(self, i: int, j: int) -> dict[str, Any]:
        rng = self.rng
        made: dict[str, Any] = {"before": f"a{i}", "after": f"a{j}"}
        if rng.random() < 0.3:
            made["type"] = rng.choice(_KINDS)
        if rng.random() < 0.3:
            made["min_lag"] = rng.randint(-2, 3)
        if rng.random() < 0.25:
            made["max_lag"] = max(0, made.get("min_lag", 0)) + rng.randint(0, 6)
        return made
