"""Job shops of the scheduling literature, and the IR task that means the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from irc.diagnostics.source import Source
from irc.frontends.importers.scheduling_files.number_lines import NumberLines
from irc.frontends.importers.scheduling_files.projects import task_of
from irc.model import Task

Alternatives = Sequence[tuple[int, int]]
"""(machine, duration) for each machine that can carry out an operation; machines count from 0."""

SetupTimes = Sequence[Sequence[Sequence[int]]]
"""For each machine, a square matrix: the set-up time from one family to another."""


@dataclass(frozen=True)
class Shop:
    """Jobs, each a chain of operations, on machines of capacity 1.

    With `setups` there is a matrix for each machine. Its rows and columns are the jobs, or, if
    `by_operation`, all operations in the order of jobs.
    """

    machines: int
    jobs: Sequence[Sequence[Alternatives]]
    setups: SetupTimes = ()
    by_operation: bool = False

    @property
    def families(self) -> list[str]:
        """The families of the set-ups, in the order of rows."""
        if self.by_operation:
            return [
                operation_id(job, position)
                for job, operations in enumerate(self.jobs, 1)
                for position in range(1, len(operations) + 1)
            ]
        return [f"job {job}" for job in range(1, len(self.jobs) + 1)]

    def has_setups(self, machine: int) -> bool:
        """Whether some set-up of a machine takes time."""
        return bool(self.setups) and any(map(any, self.setups[machine]))


def take_setups(lines: NumberLines, machines: int, size: int) -> SetupTimes:
    """The next lines as a matrix of set-up times for each machine, with `size` rows and columns."""
    return [
        [
            lines.take_numbers(f"the set-up times of machine {machine}, row {row}", size).take_many(
                "a set-up time", size
            )
            for row in range(1, size + 1)
        ]
        for machine in range(1, machines + 1)
    ]


def shop_task(shop: Shop, name: str, source: Source) -> Task:
    """The task of a job shop."""
    return task_of({"name": name, **_document(shop)}, source)


def _document(shop: Shop) -> dict[str, Any]:
    return {
        "resources": [_machine(shop, machine) for machine in range(shop.machines)],
        "actions": [
            _operation(shop, job, position, alternatives)
            for job, operations in enumerate(shop.jobs, 1)
            for position, alternatives in enumerate(operations, 1)
        ],
        "precedence": [
            {"before": operation_id(job, position), "after": operation_id(job, position + 1)}
            for job, operations in enumerate(shop.jobs, 1)
            for position in range(1, len(operations))
        ],
    }


def operation_id(job: int, position: int) -> str:
    """The id of the action of an operation; jobs and their operations count from 1."""
    return f"job {job}.{position}"


def _machine(shop: Shop, machine: int) -> dict[str, Any]:
    if not shop.has_setups(machine):
        return {"id": f"machine {machine + 1}"}
    families = shop.families
    times = [
        {"from": families[i], "to": families[j], "time": time}
        for i, row in enumerate(shop.setups[machine])
        for j, time in enumerate(row)
    ]
    return {"id": f"machine {machine + 1}", "setups": {"times": times}}


def _operation(shop: Shop, job: int, position: int, alternatives: Alternatives) -> dict[str, Any]:
    family = operation_id(job, position) if shop.by_operation else f"job {job}"
    uses = [
        {"resource": f"machine {m + 1}", **({"family": family} if shop.has_setups(m) else {})}
        for m, _ in alternatives
    ]
    durations = [duration for _, duration in alternatives]
    action: dict[str, Any] = {"id": operation_id(job, position)}
    if len(uses) == 1:
        return {**action, "duration": durations[0], "uses": uses}
    if len(set(durations)) == 1 and not shop.setups:
        one_of = [use["resource"] for use in uses]
        return {**action, "duration": durations[0], "uses": [{"one_of": one_of}]}
    return {
        **action,
        "modes": [
            {"id": use["resource"], "duration": duration, "uses": [use]}
            for use, duration in zip(uses, durations, strict=True)
        ],
    }
