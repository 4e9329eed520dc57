"""Importer for job shops, in the standard format and in Taillard's.

Standard: `jobs machines`, then for each job `machine duration` for each of its operations, machines
from 0 (or from 1, if some has the number of machines). Taillard: `jobs machines`, the durations of
each job, then its machines from 1, with or without the headings `Times` and `Machines`. After
the standard format there may be a square matrix of set-up times between jobs for each machine.
Jobs may also have any number of operations, several of them on one machine (re-entrant job shops):
then each line ends with `-1 -1`, or several lines have another length than those of the standard.
Lines of text are comments; a line `instance NAME` names the next job shop. A file may hold many.
Sources: Beasley's OR-Library; Taillard 1993, "Benchmarks for basic scheduling problems", European
Journal of Operational Research 64; Da Col and Teppan 2022, "Industrial-size job shop scheduling
with constraint programming", Operations Research Perspectives 9.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from irc.frontends.importers.scheduling_files.number_lines import (
    MOST_ELEMENTS,
    Line,
    NumberLines,
)
from irc.frontends.importers.scheduling_files.projects import stem_of
from irc.frontends.importers.scheduling_files.shops import (
    Alternatives,
    SetupTimes,
    Shop,
    shop_task,
    take_setups,
)
from irc.model import Task

_EXPECTED = (
    "expected a job shop: 'jobs machines', then a line 'machine duration …' for each job; or "
    "Taillard's format, with the durations of all jobs before their machines"
)
_INSTANCE = re.compile(r"instance\s+(\S+)", re.IGNORECASE)

Job = list[Alternatives]


def import_job_shop(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of each job shop of a file. Raises `InputError` at the first fault."""
    lines = NumberLines(text, name, _EXPECTED)
    shops = []
    while title := _next_instance(lines):
        shops.append((title, _shop(lines)))
    if not shops:
        lines.refuse("there is no job shop in the file", 0)
    for number, (title, shop) in enumerate(shops, 1):
        stem = title if title != _UNNAMED else stem_of(name)
        if title == _UNNAMED and len(shops) > 1:
            stem += f"_{number}"
        yield stem, shop_task(shop, stem, lines.source)


_UNNAMED = "\0"


def _next_instance(lines: NumberLines) -> str | None:
    """The name of the next instance, after moving to its first line of numbers."""
    title = _UNNAMED
    while lines and not lines.next.is_numbers:
        if named := _INSTANCE.match(lines.take().text):
            title = named[1]
    return title if lines else None


def _shop(lines: NumberLines) -> Shop:
    head = lines.take_numbers("the first line of the job shop")
    jobs = head.take("the number of jobs", 1, MOST_ELEMENTS)
    machines = head.take("the number of machines", 1, MOST_ELEMENTS)
    headed = len(head) > 0
    if headed and len(head) != 4:
        head.refuse("expected 'jobs machines', or these and two seeds and two bounds")
    if _heading(lines, "times"):
        return Shop(machines, _taillard(lines, jobs, machines))
    if headed:
        lines.refuse("expected the heading 'Times'", lines.next.offsets[0])
    if _is_taillard(lines, jobs, machines):
        return Shop(machines, _taillard(lines, jobs, machines))
    following = lines.lines[lines.position : lines.position + jobs]
    others = [line for line in following if len(line.words) != 2 * machines]
    take = _standard if len(others) < 2 and not any(map(_is_ended, others)) else _reentrant
    rows = [take(lines, job, machines) for job in range(1, jobs + 1)]
    chains = _counted_from_0(lines, rows, machines)
    return Shop(machines, chains, _setups(lines, jobs, machines))


def _heading(lines: NumberLines, word: str) -> bool:
    """Whether the next line is a heading, which is then passed."""
    if not lines or lines.next.text.strip(":").lower() != word:
        return False
    lines.take()
    return True


def _standard(lines: NumberLines, job: int, machines: int) -> list[tuple[int, int]]:
    row = lines.take_numbers(f"job {job}", 2 * machines)
    return [(row.take("a machine", 0, machines), row.take("a duration")) for _ in range(machines)]


def _is_taillard(lines: NumberLines, jobs: int, machines: int) -> bool:
    """Whether durations and machines of all jobs follow, a line of each for each job."""
    following = lines.lines[lines.position : lines.position + 2 * jobs]
    fitting = all(len(line.words) == machines for line in following[: jobs + 1])
    return fitting and (len(following) > jobs or machines % 2 == 1)


def _is_ended(line: Line) -> bool:
    return line.words[-2:] == ("-1", "-1")


def _reentrant(lines: NumberLines, job: int, machines: int) -> list[tuple[int, int]]:
    """The operations of a job, of which there may be any number; `-1 -1` may end its line."""
    ended = bool(lines) and _is_ended(lines.next)
    row = lines.take_numbers(f"job {job}")
    found = []
    while len(row) > 2 * ended:
        found.append((row.take("a machine", 0, machines), row.take("a duration")))
    if not found:
        row.refuse("the job has no operation")
    return found


def _counted_from_0(
    lines: NumberLines, rows: list[list[tuple[int, int]]], machines: int
) -> list[Job]:
    """The operations of each job, machines counted from 0. They may be written from 0 or from 1."""
    first = min(machine for row in rows for machine, _ in row)
    last = max(machine for row in rows for machine, _ in row)
    if first == 0 and last == machines:
        place = lines.lines[lines.position - len(rows)].offsets[0]
        lines.refuse(f"the machines are neither 0 to {machines - 1} nor 1 to {machines}", place)
    shift = 1 if last == machines else 0
    return [[[(machine - shift, duration)] for machine, duration in row] for row in rows]


def _taillard(lines: NumberLines, jobs: int, machines: int) -> list[Job]:
    durations = [
        lines.take_numbers(f"the durations of job {job}", machines).take_many(
            "a duration", machines
        )
        for job in range(1, jobs + 1)
    ]
    _heading(lines, "machines")
    chains: list[Job] = []
    for job, times in enumerate(durations, 1):
        row = lines.take_numbers(f"the machines of job {job}", machines)
        chains.append([[(row.take("a machine", 1, machines) - 1, time)] for time in times])
    return chains


def _setups(lines: NumberLines, jobs: int, machines: int) -> SetupTimes:
    """The matrices of set-up times behind a job shop; none if there are none."""
    following = lines.lines[lines.position : lines.position + jobs * machines]
    fitting = [line.is_numbers and len(line.words) == jobs for line in following]
    if len(fitting) < jobs * machines or not all(fitting):
        return []
    return take_setups(lines, machines, jobs)
