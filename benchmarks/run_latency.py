"""Measures how fast `irc run` answers: observations, and replannings with a limit of 1 s.

    python benchmarks/run_latency.py [--actions 200] [--requests 60] [--seed 0] [--time-limit 1]
                                     [--presume assume] [--target cpsat]

A shop (`online_speed.py`) is carried out through a session: at each of some instants what began or
ended since is observed, late or early, and at every third one the rest is planned again. Prints the
95th percentiles of the whole answers; exits with 1 where an observation takes over 10 ms, or a
replanning 0.3 s (1.5 s with more than 500 actions).
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import time
from fractions import Fraction

import irc
from irc.execution import Execution
from irc.model.times import json_number
from irc.service.session import Session
from irc.targets import SolveOptions
from online_speed import task_of


def asked(session: Session, **request: object) -> tuple[dict[str, object], float]:
    """(the answer to a request, its seconds)."""
    line = json.dumps(request).encode() + b"\n"
    began = time.perf_counter()
    reply = session.answer(line).line()
    return json.loads(reply), time.perf_counter() - began


def p95(seconds: list[float]) -> float:
    """The 95th percentile."""
    return sorted(seconds)[max(0, -(-len(seconds) * 95 // 100) - 1)]


def main() -> int:
    """Prints the latencies; exits with 1 where one is missed."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--actions", type=int, default=200)
    parser.add_argument("--requests", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--time-limit", type=float, default=1.0)
    parser.add_argument("--presume", default="assume")
    parser.add_argument("--target", default="cpsat")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    task = task_of(rng, options.actions, 20, even=False)
    plan = irc.solve(task, time_limit=10, workers=2)
    means = SolveOptions(options.target, time_limit=options.time_limit, workers=2)
    session = Session.start(Execution(task, plan, presume=options.presume, options=means))
    observing: list[float] = []
    planning: list[float] = []
    seen: set[str] = set()
    ended: set[str] = set()
    refused = unanswered = 0
    step = Fraction(max(1, round(plan.makespan / options.requests)))
    for k in range(1, options.requests + 1):
        now = json_number(step * k)
        asked(session, do="advance", to=now)
        entries = session.execution.schedule.entries
        for entry in entries:
            if entry.id not in seen and entry.start < step * k:
                late = min(step * k, entry.start + rng.choice((0, 0, 0, Fraction(1, 2))))
                answer, took = asked(
                    session, do="observe", action=entry.id, started=json_number(late)
                )
            elif entry.id in seen - ended and entry.end <= step * k:
                answer, took = asked(
                    session, do="observe", action=entry.id, finished=json_number(entry.end)
                )
                ended.add(entry.id)
            else:
                continue
            seen.add(entry.id)
            observing.append(took)
            refused += not answer["ok"]
        if k % 3 == 0:
            answer, took = asked(session, do="replan")
            planning.append(took)
            status = answer["step"]["schedule"]["status"] if answer["ok"] else "refused"  # type: ignore[index]
            unanswered += status not in ("optimal", "feasible")
    most = 0.3 if options.actions <= 500 else 1.5
    print(
        f"{options.actions} actions, {options.presume}: observe ({len(observing)}, {refused} "
        f"refused) p95 {1000 * p95(observing):.1f} ms, max {1000 * max(observing):.1f} ms; replan "
        f"({len(planning)}, {unanswered} without an answer) p95 {p95(planning):.2f} s, max "
        f"{max(planning):.2f} s"
    )
    return 1 if p95(observing) > 0.01 or p95(planning) > most else 0


if __name__ == "__main__":
    sys.exit(main())
