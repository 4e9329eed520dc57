"""Set-ups in the chart: drawn before the use that they are for, and explained by the legend."""

from __future__ import annotations

from pathlib import Path

import pytest

from paths import EXAMPLES
from runs import run_irc


@pytest.mark.slow
def test_the_chart_shows_setups_and_its_legend_explains_them() -> None:
    shown = run_irc("solve", str(EXAMPLES / "paint_booth.irc")).stdout
    row = next(line for line in shown.splitlines() if line.startswith("booth"))
    assert "╌" in row
    assert "╌ set-up" in shown
    assert "setup cost 28, bound 28" in shown


def test_a_task_without_setups_shows_none(tmp_path: Path) -> None:
    task = tmp_path / "task.irc"
    task.write_text("resource a\nb 3 on a\nc 2 on a\n", "utf-8")
    assert "set-up" not in run_irc("solve", str(task)).stdout
