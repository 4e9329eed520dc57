"""Compares irc with what was recorded when models' PDDL and scheduling JSON were solved.

    python benchmarks/recorded.py DATA [--what pddl specs nl-ir] [--seconds 10]
        [--largest 15] [--show] [--part K/N]

DATA is the folder of the data (docs/evaluation.md). `pddl`: domains and problems for which OPTIC
found a plan: how many are read; those with at most `--largest` steps (and all kitchens) are solved
by `auto` within `--seconds`, and their makespan is compared with that of OPTIC's own plan,
re-timed, where OPTIC's clock did not overflow; a shorter plan is judged on the original PDDL.
`specs`: scheduling JSON: how many are read of those that the paper's pipeline could read, and
whether irc's answer gets the recorded verdict. `nl-ir`: actions, durations and precedence as models
wrote them, through both targets, engines forced to run: whether both come to the same verdict and
makespan. `--show` lists what differs. `--part` takes a part of the records only.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from irc.diagnostics import InputError
from irc.driver.retimed import retimed_answer
from irc.driver.solve import solve_task
from irc.errors import IrcError
from irc.evaluation.data import Data, Record
from irc.evaluation.kitchen_solving import solved_plan
from irc.evaluation.robo import judge_plan
from irc.frontends.importers.pddl import read_pddl
from irc.frontends.importers.pddl.plan import plan_text
from irc.frontends.importers.pddl.plan_reader import read_plan
from irc.methods.nl_ir import read_nl_ir
from irc.methods.pddl_answer import read_pddl_answer
from irc.methods.schedule_spec import read_schedule_spec
from irc.model import Task
from irc.schedule import Schedule, Status
from irc.targets import SolveOptions

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from oracles.pddl_validity import NotJudgedError, reason_against

OVERFLOW = 2_147_483
"""OPTIC's clock ends there; later times of its plans mean nothing (seconds)."""


class Tally:
    """Counts, and the differences to be shown."""

    def __init__(self, show: bool) -> None:
        self.count: Counter[str] = Counter()
        self.show = show

    def differs(self, kind: str, record: Record, why: str) -> None:
        """Counts a difference."""
        self.count[kind] += 1
        if self.show:
            name = record.get("id") if "n" not in record else f"n={record['n']} pos={record['pos']}"
            print(f"  {kind}: {record['model']} {name}: {' '.join(why.split())[:200]}", flush=True)


# --- PDDL ---------------------------------------------------------------------------------------


def pddl_texts(record: Record) -> tuple[str, str] | None:
    """The domain and the problem that OPTIC was given."""
    domain, problem = record.get("domain"), record.get("problem")
    if domain is None or problem is None:
        written = read_pddl_answer(record.get("answer") or "")
        domain, problem = domain or written.domain, problem or written.problem
    return None if domain is None or problem is None else (domain, problem)


def plan_lines(record: Record) -> str:
    """OPTIC's plan as lines."""
    plan = record["plan"] or ""
    if isinstance(plan, str):
        return plan
    return "".join(f"{start:.3f}: ({name}) [{lasts:.3f}]\n" for start, name, lasts in plan)


def optics_schedule(task: Task, record: Record) -> Schedule | str:
    """OPTIC's plan, as early as its choices and order allow; or why irc cannot take it."""
    try:
        return retimed_answer(task, read_plan(plan_lines(record), "plan", task)).schedule
    except IrcError as error:
        return str(error)


def compare_pddl(data: Data, name: str, options: argparse.Namespace) -> None:
    """Prints how many of a file's domains are read and solved, and with which makespans."""
    tally = Tally(options.show)
    count = tally.count
    for record in part_of(data.records(name), options.part):
        if not record["plan"]:
            continue
        count["with a plan of OPTIC"] += 1
        texts = pddl_texts(record)
        if texts is None:
            tally.differs("no domain or problem in the answer", record, "")
            continue
        try:
            task, _ = read_pddl((texts[0], "domain"), (texts[1], "problem"), lenient=True)
        except InputError as error:
            tally.differs("not read", record, error.report.errors[0].message)
            continue
        count["read"] += 1
        if record.get("n", 0) <= options.largest:
            solve_as_optic(task, record, tally, options.seconds)
    report(name, count)


def solve_as_optic(task: Task, record: Record, tally: Tally, seconds: float) -> None:
    """Solves a task, and compares its makespan with that of OPTIC's plan."""
    count = tally.count
    count["to be solved"] += 1
    begun, wall = time.process_time(), time.monotonic()
    try:
        schedule = solve_task(task, SolveOptions(time_limit=seconds)).schedule
    except IrcError as error:
        tally.differs("failed", record, str(error))
        return
    if not schedule.answered or schedule.status is Status.INFEASIBLE:
        used = f"{time.process_time() - begun:.1f} s of CPU, {time.monotonic() - wall:.1f} s"
        tally.differs("not solved", record, f"{schedule.status} after {used}")
        return
    count["solved"] += 1
    count["proven"] += schedule.status is Status.OPTIMAL
    if schedule.makespan > OVERFLOW:
        count["beyond OPTIC's clock"] += 1
        return
    theirs = optics_schedule(task, record)
    if isinstance(theirs, str):
        tally.differs("OPTIC's plan is not valid as a schedule", record, theirs)
    elif schedule.makespan == theirs.makespan:
        count["makespan of OPTIC"] += 1
    elif schedule.makespan < theirs.makespan:
        judged = judged_by_the_oracle(record, task, schedule)
        why = f"{schedule.makespan} ({schedule.status}) against {theirs.makespan}: {judged}"
        tally.differs("shorter than OPTIC", record, why)
        count["of them accepted on the original"] += judged == "accepted"
    else:
        why = f"{schedule.makespan} ({schedule.status}) against {theirs.makespan}"
        tally.differs("longer than OPTIC", record, why)


def judged_by_the_oracle(record: Record, task: Task, schedule: Schedule) -> str:
    """What a validator that shares no code with irc says of a plan of the original PDDL."""
    texts = pddl_texts(record)
    assert texts is not None
    try:
        against = reason_against(*texts, plan_text(task, schedule))
    except (IrcError, NotJudgedError) as error:
        return f"not judged: {error}"
    return "accepted" if against is None else f"REJECTED: {against}"


# --- scheduling JSON ----------------------------------------------------------------------------


def compare_graphs(data: Data, name: str, options: argparse.Namespace) -> None:
    """Prints how many of a file's graphs are read, and have the recorded makespan."""
    tally = Tally(options.show)
    count = tally.count
    for record in part_of(data.records(name), options.part):
        recorded = record["recorded_makespan"]
        answer = read_schedule_spec(record["answer"] or "")
        if recorded is None:
            verdict = "without a schedule there" if answer.task is None else "read here alone"
            tally.differs(verdict, record, f"{answer.state}")
            continue
        count["with a schedule there"] += 1
        if answer.task is None:
            tally.differs("not read", record, str(answer.report))
            continue
        count["read"] += 1
        schedule = solve_task(answer.task, SolveOptions(time_limit=options.seconds)).schedule
        if schedule.makespan == recorded:
            count["recorded makespan"] += 1
        else:
            gold = data.steps(record["n"], record["pos"]).makespan
            why = f"{schedule.makespan} ({schedule.status}) against {recorded}; gold {gold}"
            tally.differs("another makespan", record, why)
    report(name, count)


def compare_kitchens(data: Data, name: str, options: argparse.Namespace) -> None:
    """Prints how many of a file's kitchens are read, and get the recorded verdict when solved."""
    tally = Tally(options.show)
    count = tally.count
    for record in part_of(data.records(name), options.part):
        kitchen: Mapping[str, Any] = data.kitchens[record["id"]]
        text = record["answer"] or ""
        stations, robots = kitchen.get("stations") or None, tuple(kitchen.get("robots") or ())
        answer = read_schedule_spec(text, stations, robots)
        readable = answer.task is not None or answer.actions_from_gold
        if not record["plan"]:
            verdict = "read here alone" if readable else "without a plan there"
            tally.differs(verdict, record, str(record.get("error_type")))
            continue
        count["with a plan there"] += 1
        if not readable:
            tally.differs("not read", record, str(answer.report))
            continue
        count["read"] += 1
        verdict = judge_plan(kitchen, solved_plan(text, answer, kitchen))
        if verdict.valid is record["success"]:
            count["recorded verdict"] += 1
            count["optimal"] += verdict.optimal
        else:
            why = f"valid here: {verdict.valid} ({verdict.fault}); there: {record['success']}"
            tally.differs("another verdict", record, why)
    report(name, count)


# --- IR that models wrote -----------------------------------------------------------------------


def compare_targets(data: Data, name: str, options: argparse.Namespace) -> None:
    """Prints how many of a file's answers are read, and get the same verdict on both targets."""
    tally = Tally(options.show)
    count = tally.count
    for record in part_of(data.records(name), options.part):
        answer = read_nl_ir(record["answer"] or "")
        if answer.document is None:
            count[f"not read: {answer.state}"] += 1
            if not answer.report.diagnostics:
                tally.differs("without a diagnostic", record, str(answer.state))
            continue
        count["read"] += 1
        found = [verdict_of(answer.document, target, options.seconds) for target in TARGETS]
        if found[0] == found[1]:
            count["same verdict"] += 1
            count["of them with a makespan"] += isinstance(found[0], (int, Fraction))
        else:
            tally.differs("another verdict", record, f"cpsat {found[0]}, pddl21 {found[1]}")
    report(name, count)


TARGETS = ("cpsat", "pddl21")


def verdict_of(document: Mapping[str, Any], target: str, seconds: float) -> object:
    """The makespan, or the first diagnostic's code, or the status where there is no schedule."""
    options = SolveOptions(target=target, time_limit=seconds, shortcut=False)
    try:
        schedule = solve_task(Task.model_validate(document), options).schedule
    except InputError as error:
        return error.report.errors[0].code.id
    except IrcError as error:
        return str(error)
    return schedule.makespan if schedule.answered and schedule.entries else str(schedule.status)


def part_of(records: list[Record], part: str) -> Iterator[Record]:
    """Every n-th record from the k-th on."""
    number, parts = map(int, part.split("/"))
    yield from records[number - 1 :: parts]


def report(name: str, count: Counter[str]) -> None:
    """Prints the counts of one file."""
    print(f"{name}: " + ", ".join(f"{n} {kind}" for kind, n in count.items()), flush=True)


COMPARED = {
    "pddl": (("xxl_pddl", compare_pddl), ("robo_pddl", compare_pddl)),
    "nl-ir": (("xxl_nl_cpsat", compare_targets),),
    "specs": (("xxl_cpsat", compare_graphs), ("robo_cpsat", compare_kitchens)),
}


def main() -> int:
    """Prints the counts of each file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("data", type=Path)
    parser.add_argument("--what", nargs="*", choices=COMPARED, default=list(COMPARED))
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--largest", type=int, default=15)
    parser.add_argument("--show", action="store_true")
    parser.add_argument("--part", default="1/1", metavar="K/N")
    options = parser.parse_args()
    data = Data(options.data)
    for what in options.what:
        for name, compare in COMPARED[what]:
            compare(data, name, options)
    return 0


if __name__ == "__main__":
    sys.exit(main())
