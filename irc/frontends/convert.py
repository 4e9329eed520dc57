"""Converts between formats: in, tasks of other formats; out, IR JSON or the DSL."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report, did_you_mean
from irc.driver.files import write_folder, write_whole
from irc.errors import IrcError
from irc.frontends.files import read_task
from irc.frontends.formats import (
    DSL_SUFFIX,
    EXPORTERS,
    FORMATS,
    IMPORTERS,
    KNOWN_SUFFIXES,
    MS_PROJECT,
    PDDL,
    PDDL_PLAN,
    PLAN_EXPORTERS,
    PLAN_LINES,
    PLANNER,
    SCHEDULE,
    SCHEDULE_SPEC,
    SUFFIXES,
    TABLES,
    TARGET_FORMATS,
    format_of,
    load_exporter,
    load_importer,
    load_plan_exporter,
)
from irc.frontends.json.document import read_document
from irc.frontends.texts import read_text
from irc.model import Task
from irc.model.canonical import written_task
from irc.schedule import dump_json
from irc.schedule.reading import schedule_from_json
from irc.targets import UnknownTarget

_UNSAFE = re.compile(r"[^\w.-]+")


class ConversionUseError(IrcError):
    """The options do not fit the format; the message says what to do."""


def written_as(output: Path, task: Task) -> str:
    """The text of a task in the language that a file's suffix names."""
    if output.suffix.lower() == DSL_SUFFIX:
        from irc.frontends.dsl.printer import print_task

        return print_task(task)
    return dump_json(written_task(task))


@dataclass(frozen=True)
class Beside:
    """Files and values that some formats need beside the input.

    `problem` is the file of a PDDL problem, and `domain` that of its domain where the input is a
    plan or a schedule; `lenient` reads PDDL as models write it. `instance` is the file of the
    kitchen, and `stations` are the capacities (`grill=2`), of a scheduling JSON. `schedule` is the
    file of the schedule that is written in place of its task, and as a baseline, too, with
    `baseline`.
    """

    problem: str | None = None
    instance: str | None = None
    stations: tuple[str, ...] = ()
    domain: str | None = None
    lenient: bool = False
    schedule: str | None = None
    baseline: bool = False


OnReport = Callable[[Report], None]


def convert_file(
    file: str,
    source: str | None,
    output: Path,
    beside: Beside = Beside(),
    *,
    target: str | None = None,
    on_report: OnReport = lambda report: None,
) -> list[Path]:
    """Writes the task (or one task for each instance) and returns the written files.

    `source` is one of `FORMATS`, and `target` one of `TARGET_FORMATS`; None is what the suffix
    of the file or of `output` names. As `irc`, a task is written in the DSL if `output` ends in
    `.irc`, else as JSON. `lenient` reads PDDL as models write it;
    `on_report` gets the warnings about PDDL and MS Project.

    An importer of instances also accepts a folder, whose files of the format it reads in order of
    name. It writes a folder; one instance is written as a file if the suffix of `output` names a
    format.
    Raises `InputError`, `WriteError`, `ConversionUseError`, `EngineMissing` if an importer needs an
    extra that is not installed, or `UnknownTarget` for an unknown format.
    """
    source = format_of(file) if source is None else source
    if source not in FORMATS:
        raise UnknownTarget("input format", source, list(FORMATS))
    target = format_of(output) if target is None else target
    if target not in TARGET_FORMATS:
        raise UnknownTarget("output format", target, list(TARGET_FORMATS))
    _require_fitting(source, beside)
    _require_schedule(source, target, beside)
    if beside.schedule is not None:
        task = _sound(_read_one(file, source, beside, on_report))
        write_whole(output, _planned(task, beside.schedule, target, baseline=beside.baseline))
        return [output]
    if source in IMPORTERS:
        return _convert_instances(file, source, output, target)
    if source == PLAN_LINES:
        from irc.frontends.importers.plan_lines import import_plan

        write_whole(output, dump_json(import_plan(*read_text(file)).to_dict()))
    elif source in (PDDL_PLAN, SCHEDULE):
        task = _read_pddl(beside.domain, beside, on_report)
        write_whole(output, _converted_plan(file, source, task))
    else:
        return _write_task(output, _read_one(file, source, beside, on_report), target)
    return [output]


def _require_fitting(source: str, beside: Beside) -> None:
    """Raises `ConversionUseError` where an option is for another format, or one is missing."""
    if source in (PDDL_PLAN, SCHEDULE):
        if beside.domain is None or beside.problem is None:
            raise ConversionUseError(f"--from {source} needs --domain FILE and --problem FILE")
    elif source != PDDL and (beside.problem is not None or beside.lenient):
        option = "--lenient" if beside.problem is None else "--problem"
        raise ConversionUseError(f"{option} is for --from {PDDL}")
    if (beside.instance is not None or beside.stations) and source != SCHEDULE_SPEC:
        raise ConversionUseError(f"--instance and --station are for --from {SCHEDULE_SPEC}")


def _require_schedule(source: str, target: str, beside: Beside) -> None:
    """Raises `ConversionUseError` where a schedule is missing, or is for another format."""
    if beside.baseline and (beside.schedule is None or target != MS_PROJECT):
        raise ConversionUseError(f"--baseline is for --to {MS_PROJECT} with --schedule FILE")
    if beside.schedule is None:
        if target in PLAN_EXPORTERS and target not in EXPORTERS:
            raise ConversionUseError(f"--to {target} writes a schedule: --schedule FILE")
        return
    if target not in PLAN_EXPORTERS:
        formats = " or ".join(PLAN_EXPORTERS)
        raise ConversionUseError(f"--schedule is for --to {formats}")
    if source in (*IMPORTERS, PLAN_LINES, PDDL_PLAN, SCHEDULE):
        raise ConversionUseError(
            f"--schedule needs one task: write it with --from {source} -o FILE.json first"
        )


def _planned(task: Task, file: str, target: str, *, baseline: bool) -> str:
    """The text of a task's schedule in the format `target`. Raises `InputError`."""
    document = read_document(*read_text(file))
    schedule = schedule_from_json(document.content, document.source)
    known = {action.id for action in task.actions}
    for entry in schedule.entries:
        if entry.id not in known:
            message = f"the schedule has an entry of {entry.id!r}, which the task does not have"
            hint = did_you_mean(entry.id, known) or "give the schedule of this very task"
            fault = Diagnostic(Code.BAD_SCHEDULE, message, offset=0, hint=hint)
            raise InputError(Report((fault,), document.source))
    return load_plan_exporter(target)(task, schedule, baseline)


def _read_one(file: str, source: str, beside: Beside, on_report: OnReport) -> Task:
    """The task of a format that has one in a file."""
    if source == PLANNER:
        from irc.frontends.importers.planner import import_planner

        return import_planner(*read_text(file))
    if source == SCHEDULE_SPEC:
        return _read_schedule_spec(file, beside)
    if source == TABLES:
        from irc.frontends.tables.reader import read_tables

        return read_tables(file)
    if source == MS_PROJECT:
        from irc.frontends.ms_project.reader import read_ms_project

        task, report = read_ms_project(*read_text(file))
        on_report(report)
        return task
    return read_task(file).task if source == "irc" else _read_pddl(file, beside, on_report)


def _read_pddl(domain: str | None, beside: Beside, on_report: OnReport) -> Task:
    if domain is None:
        raise ConversionUseError("the domain is missing: --domain FILE")
    task, report = read_pddl_files(domain, beside.problem, lenient=beside.lenient)
    on_report(report)
    return task


def _converted_plan(file: str, source: str, task: Task) -> str:
    """The text of a plan's schedule, or of a schedule's plan."""
    from irc.frontends.importers.pddl.plan import PlanError, plan_text
    from irc.frontends.importers.pddl.plan_reader import read_plan

    text, name = read_text(file)
    if source == PDDL_PLAN:
        schedule = read_plan(text, name, task)
        return dump_json(replace(schedule, task=task.name, time_unit=task.time_unit).to_dict())
    document = read_document(text, name)
    try:
        return plan_text(task, schedule_from_json(document.content, document.source))
    except PlanError as error:
        diagnostic = Diagnostic(Code.BAD_SCHEDULE, str(error), offset=0)
        raise InputError(Report((diagnostic,), document.source)) from None


def _read_schedule_spec(file: str, beside: Beside) -> Task:
    from irc.frontends.importers.instances import read_instances
    from irc.frontends.importers.schedule_spec import import_schedule_spec

    stations, kitchen = _capacities(beside.stations), None
    if beside.instance is not None:
        (instance, *more), faults = read_instances(*read_text(beside.instance))
        if more:
            faults.add(f"{beside.instance} holds more than one instance", (1,))
            faults.raise_any()
        kitchen = instance.value
        if not isinstance(kitchen, Mapping):
            instance.members()
            faults.raise_any()
        stations = {**_whole_amounts(kitchen.get("stations")), **stations}
    return import_schedule_spec(*read_text(file), stations, kitchen)


def _whole_amounts(stations: Any) -> dict[str, int]:
    listed = stations.items() if isinstance(stations, Mapping) else ()
    return {name: amount for name, amount in listed if type(amount) is int and amount >= 0}


def _capacities(stations: tuple[str, ...]) -> dict[str, int]:
    found = {}
    for written in stations:
        name, _, amount = written.rpartition("=")
        if not name or not amount.isascii() or not amount.isdigit():
            raise ConversionUseError(f"--station {written!r}: expected a capacity such as grill=2")
        found[name] = int(amount)
    return found


def _write_task(output: Path, task: Task, target: str) -> list[Path]:
    """Writes a task in a format: a file, or a folder of CSV files."""
    if target != TABLES:
        write_whole(output, _exported(output, task, target))
        return [output]
    from irc.frontends.tables.files import csv_text, workbook_bytes
    from irc.frontends.tables.writer import sheets_of_task

    sheets = sheets_of_task(_sound(task))
    if output.suffix.lower() == ".xlsx":
        write_whole(output, workbook_bytes(sheets))
        return [output]
    if output.suffix:
        raise ConversionUseError(
            f"tables are written as a workbook or as a folder of CSV files: -o {output.stem}.xlsx "
            f"or -o {output.stem} --to {TABLES}"
        )
    write_folder(output, {f"{sheet.name}.csv": csv_text(sheet) for sheet in sheets})
    return [output / f"{sheet.name}.csv" for sheet in sheets]


def _sound(task: Task) -> Task:
    """The task, whose names all refer to something. Raises `InputError` otherwise."""
    from irc.checks.structure import check_structure

    findings = Findings()
    check_structure(task, findings)
    if findings.has_errors:
        raise InputError(Report(tuple(findings.items), task.source))
    return task


def _exported(output: Path, task: Task, target: str) -> str:
    """The text of a task in the format `target`. Raises `InputError` with what it cannot say."""
    if target == "irc":
        return written_as(output, task)
    return load_exporter(target)(_sound(task))


def _convert_instances(file: str, source: str, output: Path, target: str) -> list[Path]:
    # All instances are read before the first file is written.
    importer = load_importer(source)
    files: dict[str, Task] = {}
    for one in _files(file, SUFFIXES.get(source, (".json",))):
        for stem, task in importer(*read_text(one)):
            safe = _UNSAFE.sub("_", stem)[:100]
            while safe in files:
                safe += "_"
            files[safe] = task
    named = output.suffix.lower() in (".json", DSL_SUFFIX, *KNOWN_SUFFIXES)
    if named and not output.is_dir():
        if len(files) != 1:
            message = f"{len(files)} tasks need a folder: -o {output.stem} instead of {output.name}"
            raise ConversionUseError(message)
        return _write_task(output, next(iter(files.values())), target)
    if target == TABLES:
        raise ConversionUseError("write one task as tables: -o FILE.xlsx")
    suffix = SUFFIXES.get(target, (".json",))[0]
    written = {
        f"{stem}{suffix}": _exported(Path("task.json"), task, target)
        for stem, task in files.items()
    }
    write_folder(output, written)
    return [output / name for name in written]


def _files(file: str, suffixes: tuple[str, ...]) -> list[str]:
    folder = Path(file)
    if not folder.is_dir():
        return [file]
    found = sorted(str(path) for path in folder.iterdir() if path.suffix.lower() in suffixes)
    if not found:
        message = f"the folder {file!r} has no {' or '.join(suffixes)} files"
        raise InputError(Report((Diagnostic(Code.UNREADABLE, message),)))
    return found


def read_pddl_files(
    domain: str, problem: str | None, *, lenient: bool = False
) -> tuple[Task, Report]:
    """The task of a domain's and a problem's files, and the warnings about them."""
    if problem is None:
        raise ConversionUseError(f"--from {PDDL} also needs the problem: --problem FILE")
    from irc.frontends.importers.pddl import read_pddl

    return read_pddl(read_text(domain), read_text(problem), lenient=lenient)
