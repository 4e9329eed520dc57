"""The figures of a race: a row for each competitor, over all instances and for each family."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from racing.running import Run


@dataclass(frozen=True)
class Row:
    """The figures of a competitor. Gaps and the integral are shares, times processor seconds.

    `behind` is the share of its runs on which some other competitor had a better schedule. The
    primal integral is the mean gap over the time of a run, where no schedule counts as 1 (Berthold,
    "Measuring the impact of primal heuristics", OR Letters 41, 2013).
    """

    competitor: str
    runs: int
    gap: float
    without: int
    proven: int
    bound_gap: float
    first: float
    best: float
    integral: float
    behind: float
    cpu: float
    faulty: int


def references(runs: Iterable[Run], known: Mapping[str, int]) -> dict[str, int]:
    """The makespan that each gap is measured against: the best known, or the best of the race."""
    found: dict[str, int] = {}
    for run in runs:
        if run.value is not None and not run.fault:
            found[run.instance] = min(run.value, found.get(run.instance, run.value))
    return {name: known.get(name, value) for name, value in found.items()}


def gap_of(value: int | None, reference: int) -> float:
    """How far a makespan is above the reference; 1 where there is none."""
    return 1.0 if value is None else (value - reference) / max(1, reference)


def integral_of(run: Run, reference: int, seconds: float) -> float:
    """The mean over the time of a run of the gap of its best schedule so far."""
    total, at, gap = 0.0, 0.0, 1.0
    for time, value in run.trace:
        total += (min(time, seconds) - at) * gap
        at, gap = min(time, seconds), min(1.0, gap_of(value, reference))
    return (total + (seconds - at) * gap) / seconds


def rows(runs: Sequence[Run], known: Mapping[str, int], seconds: float) -> list[Row]:
    """The row of each competitor, in the order in which they came."""
    reference = references(runs, known)
    best: dict[tuple[str, int], int] = {}
    for run in runs:
        if run.value is not None and not run.fault:
            key = run.instance, run.seed
            best[key] = min(run.value, best.get(key, run.value))
    names = dict.fromkeys(run.competitor for run in runs)
    return [
        _row(name, [run for run in runs if run.competitor == name], reference, best, seconds)
        for name in names
    ]


def _row(
    name: str,
    runs: Sequence[Run],
    reference: Mapping[str, int],
    best: Mapping[tuple[str, int], int],
    seconds: float,
) -> Row:
    judged = [run for run in runs if run.instance in reference]
    answered = [run for run in judged if run.value is not None and not run.fault]
    bounds = [
        (reference[run.instance] - (run.bound or 0)) / max(1, reference[run.instance])
        for run in judged
    ]
    behind = [
        run.value is None or bool(run.fault) or run.value > best[run.instance, run.seed]
        for run in judged
        if (run.instance, run.seed) in best
    ]
    return Row(
        competitor=name,
        runs=len(runs),
        gap=_mean(
            gap_of(None if run.fault else run.value, reference[run.instance]) for run in judged
        ),
        without=len(runs) - len(answered),
        proven=sum(run.proven and not run.fault for run in runs),
        bound_gap=_mean(bounds),
        first=_mean(run.first for run in answered if run.first is not None),
        best=_mean(run.best for run in answered if run.best is not None),
        integral=_mean(integral_of(run, reference[run.instance], seconds) for run in judged),
        behind=_mean(map(float, behind)),
        cpu=_mean(run.cpu for run in runs),
        faulty=sum(bool(run.fault) for run in runs),
    )


def _mean(values: Iterable[float]) -> float:
    found = list(values)
    return fmean(found) if found else 0.0


HEADINGS = (
    *("competitor", "runs", "gap %", "none", "proven", "bound %", "first s", "best s"),
    *("integral %", "behind %", "CPU s", "faulty"),
)


def table(found: Sequence[Row]) -> str:
    """The rows as a table in Markdown."""
    lines = ["| " + " | ".join(HEADINGS) + " |", "|" + "---|" * len(HEADINGS)]
    for row in found:
        cells = [
            row.competitor,
            str(row.runs),
            f"{100 * row.gap:.2f}",
            str(row.without),
            str(row.proven),
            f"{100 * row.bound_gap:.2f}",
            f"{row.first:.2f}",
            f"{row.best:.2f}",
            f"{100 * row.integral:.2f}",
            f"{100 * row.behind:.0f}",
            f"{row.cpu:.2f}",
            str(row.faulty),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def progress(
    runs: Sequence[Run], known: Mapping[str, int], seconds: float, points: int = 40
) -> dict[str, list[tuple[float, float]]]:
    """For each competitor, (processor seconds, mean gap at that time), evenly spread."""
    reference = references(runs, known)
    curves: dict[str, list[tuple[float, float]]] = {}
    for name in dict.fromkeys(run.competitor for run in runs):
        own = [run for run in runs if run.competitor == name and run.instance in reference]
        curves[name] = [
            (at, _mean(gap_of(_value_at(run, at), reference[run.instance]) for run in own))
            for at in (seconds * k / points for k in range(1, points + 1))
        ]
    return curves


def _value_at(run: Run, at: float) -> int | None:
    found = [value for time, value in run.trace if time <= at]
    return found[-1] if found and not run.fault else None
