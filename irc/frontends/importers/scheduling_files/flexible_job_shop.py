"""Importer for flexible job shops (`.fjs`).

Format: `jobs machines`, perhaps with the mean number of machines; for each job its number of
operations, and for each of these its number of machines and `machine duration` for each of them,
machines from 1 (or from 0, if some is 0). Behind the jobs there may be a square matrix of set-up
times between all operations for each machine. Sources: Brandimarte 1993, "Routing and scheduling in
a flexible job shop by tabu search", Annals of Operations Research 41; set-ups as in the instances
of Fattahi et al. 2007.
"""

from __future__ import annotations

from collections.abc import Iterator

from irc.frontends.importers.scheduling_files.number_lines import (
    MOST_ELEMENTS,
    NumberLines,
    Numbers,
)
from irc.frontends.importers.scheduling_files.projects import stem_of
from irc.frontends.importers.scheduling_files.shops import SetupTimes, Shop, shop_task, take_setups
from irc.model import Task

_EXPECTED = (
    "expected a flexible job shop: 'jobs machines', then a line for each job: 'operations', and "
    "for each operation 'machines machine duration …'"
)
_MOST_SETUPS = 4_000_000

Operations = list[list[tuple[int, int]]]


def import_flexible_job_shop(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of a flexible job shop. Raises `InputError` at the first fault."""
    lines = NumberLines(text, name, _EXPECTED)
    jobs, machines = _head(lines)
    first = lines.position
    chains = [_job(lines, job, machines) for job in range(1, jobs + 1)]
    chains = _counted_from_0(lines, first, chains, machines)
    setups = _setups(lines, sum(map(len, chains)), machines)
    if lines:
        lines.refuse("more lines than the format has", lines.next.offsets[0])
    stem = stem_of(name)
    yield stem, shop_task(Shop(machines, chains, setups, by_operation=True), stem, lines.source)


def _head(lines: NumberLines) -> tuple[int, int]:
    """The numbers of jobs and machines. The third number of the line, a mean, says nothing new."""
    line = lines.take()
    if not 2 <= len(line.words) <= 3:
        lines.refuse("expected 'jobs machines', perhaps with a mean", line.offsets[0])
    head = Numbers(lines, "the first line", line.words[:2], line.offsets[:2])
    jobs = head.take("the number of jobs", 1, MOST_ELEMENTS)
    return jobs, head.take("the number of machines", 1, MOST_ELEMENTS)


def _job(lines: NumberLines, job: int, machines: int) -> Operations:
    row = lines.take_numbers(f"job {job}")
    operations = []
    for number in range(1, row.take("the number of operations", 0, MOST_ELEMENTS) + 1):
        row.what = f"job {job}, operation {number}"
        amount = row.take("the number of its machines", 1, machines)
        operations.append(
            [(row.take("a machine", 0, machines), row.take("a duration")) for _ in range(amount)]
        )
    row.end()
    return operations


def _counted_from_0(
    lines: NumberLines, first: int, chains: list[Operations], machines: int
) -> list[Operations]:
    numbers = {machine for chain in chains for ways in chain for machine, _ in ways}
    if {0, machines} <= numbers:
        message = f"the machines are neither 1 to {machines} nor 0 to {machines - 1}"
        lines.refuse(message, lines.lines[first].offsets[0])
    if 0 in numbers:
        return chains
    return [[[(m - 1, time) for m, time in ways] for ways in chain] for chain in chains]


def _setups(lines: NumberLines, operations: int, machines: int) -> SetupTimes:
    """The matrices of set-up times; none if the file ends behind the jobs."""
    if not lines:
        return []
    if machines * operations**2 > _MOST_SETUPS:
        lines.refuse(f"more than {_MOST_SETUPS:,} set-up times", lines.next.offsets[0])
    return take_setups(lines, machines, operations)
