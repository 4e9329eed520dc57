"""Models with pauses that ended CP-SAT's process, each solved in a process of its own."""

from __future__ import annotations

import subprocess
import sys

_TASK = """
import irc
halves = [
    {"days": ["mon", "tue", "wed", "thu", "fri"], "from": start, "to": end}
    for start, end in (("08:00", "12:00"), ("13:00", "17:00"))
]
for last in (120, 240):
    task = irc.Task(
        time_unit="min",
        origin="2026-03-02T08:00:00",
        calendars=[{"id": "c", "open": halves}],
        actions=[
            {"id": name, "duration": duration, "calendar": "c", "breaks": "pause"}
            for name, duration in (("a", 480), ("b", 240), ("lead", last))
        ],
        precedence=[
            {"before": "a", "after": "lead", "type": "finish-finish"},
            {"before": "lead", "after": "b", "type": "start-finish"},
        ],
        objective=["minimize_makespan", "minimize_flow_time"],
    )
    print(irc.solve(task, time_limit=20, workers=1).status.value)
"""


def test_pauses_beside_start_finish_do_not_end_the_process() -> None:
    """Presolve of CP-SAT 9.15 failed a check of its own: `VarToConstraints(var).empty()`."""
    done = subprocess.run(
        [sys.executable, "-c", _TASK], capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stdout.split()) == (0, ["optimal", "optimal"]), done.stderr
