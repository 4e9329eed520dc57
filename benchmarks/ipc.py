"""Reads and solves temporal domains of planning competitions, and judges each plan by itself.

    python benchmarks/ipc.py FOLDER [--instance 1] [--seconds 30] [--only TEXT …] [--read-only]
        [--target cpsat] [--engine auto] [--save FOLDER]

FOLDER has the domains: `…/VARIANT/domain.pddl` or `…/VARIANT/domains/*.pddl`, each with
`…/VARIANT/instances/*.pddl` (as in github.com/potassco/pddl-instances). Variants without durative
actions, with preferences or with trajectory constraints are left out. Each is read and solved in a
process of its own; `--seconds` are for both together. A plan counts if
`tests/oracles/pddl_validity.py`, which shares no code with irc, accepts it on the original PDDL.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

MORE_SECONDS = 60
"""Beyond the time limit, for what cannot be stopped, and for judging."""


class Variant(NamedTuple):
    """A domain and one of its problems."""

    name: str
    domain: Path
    problem: Path


def _in_order(path: Path) -> list[tuple[int, str]]:
    parts = re.findall(r"\d+|\D+", path.name)
    return [(int(part), "") if part.isdigit() else (0, part) for part in parts]


def variants(folder: Path, number: int) -> Iterator[Variant]:
    """The variants below a folder, each with its instance of this number (from 1)."""
    for instances in sorted(folder.glob("**/instances")):
        home = instances.parent
        problems = sorted(instances.glob("*.pddl"), key=_in_order)
        domains = sorted(home.glob("domains/*.pddl"), key=_in_order) or [home / "domain.pddl"]
        if len(problems) < number or not domains[0].is_file():
            continue
        domain = domains[0] if len(domains) == 1 else domains[number - 1]
        problem = problems[number - 1]
        texts = [path.read_text("utf-8", "replace").lower() for path in (domain, problem)]
        if ":durative-action" in re.sub(r":durative-actions", "", texts[0]) and not any(
            re.search(r"\((?:preference|:constraints)\b", text) for text in texts
        ):
            name = "/".join(part for part in home.relative_to(folder).parts if part != "domains")
            yield Variant(name, domain, problem)


def measured(variant: Variant, seconds: float, target: str, engine: str) -> dict[str, Any]:
    """One variant, read, and solved if there is time for it. Runs in a process of its own."""
    from irc.diagnostics import InputError
    from irc.driver.solve import solve_task
    from irc.errors import IrcError
    from irc.frontends.importers.pddl import import_pddl
    from irc.frontends.importers.pddl.plan import plan_text
    from irc.targets import SolveOptions
    from oracles.pddl_validity import NotJudgedError, reason_against

    row: dict[str, Any] = {"variant": variant.name}
    texts = [path.read_text("utf-8", "replace") for path in variant[1:]]
    begun = time.monotonic()
    try:
        task = import_pddl((texts[0], variant.domain.name), (texts[1], variant.problem.name))
    except InputError as error:
        return row | {"refused": " ".join(error.report.diagnostics[0].message.split())[:160]}
    finally:
        row["read_seconds"] = time.monotonic() - begun
    row |= {"actions": len(task.actions), "variables": len(task.state)}
    print(json.dumps(row), flush=True)  # So that it is known where the process has to be ended.
    if not seconds:
        return row
    left = seconds - row["read_seconds"]
    if left <= 0:
        return row | {"failed": f"read in {row['read_seconds']:.1f} s, {row['actions']} actions"}
    begun = time.monotonic()
    try:
        answer = solve_task(task, SolveOptions(target=target, engine=engine, time_limit=left))
    except IrcError as error:
        return row | {"failed": f"{type(error).__name__}: {error}"[:160]}
    row |= {"seconds": time.monotonic() - begun, "status": str(answer.schedule.status)}
    row["engine"] = answer.schedule.engine
    if not answer.schedule.entries:
        return row
    row["makespan"] = float(answer.schedule.makespan)
    try:
        plan = plan_text(task, answer.schedule)
        row["plan"] = plan
        row["against"] = reason_against(*texts, plan)
    except (IrcError, NotJudgedError) as error:
        row["against"] = f"{type(error).__name__}: {error}"
    return row


def in_a_process(variant: Variant, options: argparse.Namespace) -> dict[str, Any]:
    """The row of a variant; what ends the process is a failure of that variant alone."""
    command = [sys.executable, __file__, *map(str, variant), "--one"]
    command += ["--seconds", str(options.seconds)]
    command += ["--target", options.target, "--engine", options.engine]
    try:
        ended = subprocess.run(
            command, capture_output=True, text=True, timeout=options.seconds + MORE_SECONDS
        )
        return dict(json.loads(ended.stdout.splitlines()[-1]))
    except subprocess.TimeoutExpired as late:
        printed = (late.stdout or b"").splitlines()[-1:]
        row = dict(json.loads(printed[0])) if printed else {"variant": variant.name}
        return row | {"failed": f"ended {MORE_SECONDS} s after its time limit"}
    except (IndexError, ValueError):
        why = (ended.stderr.strip().splitlines() or [f"exit status {ended.returncode}"])[-1]
        return {"variant": variant.name, "failed": why[:160]}


def shown(row: dict[str, Any]) -> str:
    """The row as a line of text."""
    if "refused" in row or "failed" in row:
        kind = "refused" if "refused" in row else "failed"
        return f"{row['variant']:70} {kind}: {row[kind]}"
    line = f"{row['variant']:70} read {row['read_seconds']:5.1f} s {row['actions']:6} actions"
    if "status" not in row:
        return line
    line += f"  {row['status']:9} {row['seconds']:5.1f} s"
    if "makespan" in row:
        verdict = "accepted" if row["against"] is None else f"REJECTED: {row['against']}"
        line += f"  makespan {row['makespan']:<10g} {verdict}  [{row['engine']}]"
    return line


def main() -> None:
    """Prints a row for each variant, and a summary."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("folder", nargs="+")
    parser.add_argument("--instance", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=30)
    parser.add_argument("--only", nargs="*", default=[], help="texts of which the name has one")
    parser.add_argument("--read-only", action="store_true")
    parser.add_argument("--target", default="cpsat")
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--save", type=Path, help="a folder for the plans")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.read_only:
        options.seconds = 0
    if options.one:
        name, domain, problem = options.folder
        variant = Variant(name, Path(domain), Path(problem))
        print(json.dumps(measured(variant, options.seconds, options.target, options.engine)))
        return
    count: Counter[str] = Counter()
    for variant in variants(Path(options.folder[0]), options.instance):
        if options.only and not any(text in variant.name for text in options.only):
            continue
        row = in_a_process(variant, options)
        count["variants"] += 1
        count["read"] += "actions" in row
        count["solved"] += "makespan" in row
        count["accepted"] += "makespan" in row and row["against"] is None
        print(shown(row), flush=True)
        if options.save and "plan" in row:
            options.save.mkdir(parents=True, exist_ok=True)
            file = options.save / f"{variant.name.replace('/', '_')}.plan"
            file.write_text(row["plan"], encoding="utf-8")
    kinds = ("variants", "read", "solved", "accepted")
    print(", ".join(f"{count[kind]} {kind}" for kind in kinds))


if __name__ == "__main__":
    main()
