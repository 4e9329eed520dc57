"""The parts of benchmarks/league.py: generators, the judge of schedules, figures, broken files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from paths import ROOT


@pytest.fixture(autouse=True)
def _with_benchmarks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))


def test_the_generator_of_job_shops_gives_taillards_first_instance() -> None:
    from racing.generate import job_shop

    first = job_shop(15, 15, 840612802, 398197754)[0]
    assert [d for _, d in first] == [94, 66, 10, 53, 26, 15, 65, 82, 10, 27, 93, 92, 96, 70, 83]
    assert [m + 1 for m, _ in first] == [7, 13, 5, 8, 4, 3, 11, 12, 9, 15, 10, 14, 6, 1, 2]


def test_a_generated_project_has_no_implied_precedence_and_is_read_as_it_was_meant() -> None:
    from irc.frontends.formats import load_importer
    from racing.gather import instance_of
    from racing.generate import project

    ((stem, task),) = load_importer("psplib")(project(30, 1.8, 0.5, 0.2, 7), "p.sm")
    instance = instance_of(stem, task)
    after: dict[int, set[int]] = {}
    for lag in instance.lags:
        after.setdefault(lag.before, set()).add(lag.after)

    def below(i: int) -> set[int]:
        return {k for j in after.get(i, ()) for k in (j, *below(j))}

    assert instance.family == "rcpsp"
    assert sum(map(len, after.values())) >= 1.5 * 30
    assert not [(i, j) for i, js in after.items() for j in js if any(j in below(k) for k in js)]
    assert all(sum(1 for _ in way.holds) <= 2 for (way,) in instance.jobs)


def two_jobs(capacity: int = 1) -> Any:
    from racing.instance import Instance, Lag, Way

    ways = [[Way("", 3, [(0, 1)], [])], [Way("", 2, [(0, 1)], []), Way("", 1, [], [(0, 2)])]]
    lags = [Lag(0, 1, 1, from_end=False)]
    return Instance("two", "multi-mode", ["a", "b"], ways, lags, [capacity], [1])


@pytest.mark.parametrize(
    ("starts", "ways", "fault"),
    [
        ((0, 3), (0, 0), None),
        ((0, 2), (0, 0), "resource 0 is overloaded"),
        ((0, 0), (0, 0), "starts too early"),
        ((-1, 3), (0, 0), "starts before 0"),
        ((0, 1), (0, 1), "budget 0 is exceeded"),
    ],
)
def test_the_league_judges_each_schedule(
    starts: tuple[int, int], ways: tuple[int, int], fault: str | None
) -> None:
    from racing.instance import faults

    found = faults(two_jobs(), starts, ways)
    assert found == [] if fault is None else fault in found[0]


def test_gap_and_integral_count_the_time_without_a_schedule() -> None:
    from racing.figures import rows
    from racing.running import Run

    slow = Run("a", "rcpsp", "slow", 0, 11, 10, False, 5.0, 5.0, [(5.0, 11)])
    fast = Run("a", "rcpsp", "fast", 0, 10, 10, True, 1.0, 1.0, [(1.0, 10)])
    first, second = rows([slow, fast], {}, 10.0)
    assert (first.gap, first.behind, first.integral) == pytest.approx((0.1, 1.0, 0.55))
    assert (second.gap, second.behind, second.integral) == pytest.approx((0.0, 0.0, 0.1))


def test_broken_files_are_named_and_skipped(tmp_path: Path) -> None:
    from racing.gather import gather

    (tmp_path / "good.jsp").write_text("1 2\n0 3 1 4\n")
    (tmp_path / "broken.sm").write_text("nothing of a project\n")
    (tmp_path / "binary.fjs").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "other.xlsx").write_text("")
    found = gather(tmp_path)
    assert [instance.name for instance, _ in found.instances] == ["good"]
    assert [line.split(":")[0].rsplit("/", 1)[-1] for line in found.skipped] == [
        *("binary.fjs", "broken.sm", "other.xlsx"),
    ]


def test_only_instances_that_every_competitor_has_had_are_compared() -> None:
    from league import comparable
    from racing.running import Run

    runs = [Run(i, "rcpsp", who, 0) for i, who in (("a", "x"), ("a", "y"), ("b", "x"))]
    assert comparable(runs, ["x", "y"]) == runs[:2]
