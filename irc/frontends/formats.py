"""The formats that `irc convert` reads and writes, by name and by the suffix of a file."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pathlib import Path

from irc.model import Task
from irc.schedule import Schedule

Importer = Callable[[str, str], Iterator[tuple[str, Task]]]
"""(text, name) → (file stem, task) of each instance in the text."""

IMPORTERS: Mapping[str, str] = {
    "asyncplan": "irc.frontends.importers.asyncplan:import_asyncplan",
    "robo": "irc.frontends.importers.robo:import_robo",
    "robo-online": "irc.frontends.importers.robo_online:import_robo_online",
    "robotouille": "irc.frontends.importers.robotouille:import_robotouille",
    "psplib": "irc.frontends.importers.scheduling_files.psplib:import_psplib",
    "rcpsp-max": "irc.frontends.importers.scheduling_files.rcpsp_max:import_rcpsp_max",
    "patterson": "irc.frontends.importers.scheduling_files.patterson:import_patterson",
    "pyjobshop": "irc.frontends.importers.pyjobshop:import_pyjobshop",
    "job-shop": "irc.frontends.importers.scheduling_files.job_shop:import_job_shop",
    "flexible-job-shop": (
        "irc.frontends.importers.scheduling_files.flexible_job_shop:import_flexible_job_shop"
    ),
}
"""Formats of instances, perhaps many in a file, and their `Importer`s, loaded when needed."""

Exporter = Callable[[Task], str]
"""A task → its text in another format. Raises `InputError` with what the format cannot say."""

EXPORTERS: Mapping[str, str] = {
    "psplib": "irc.frontends.exporters.projects:write_psplib",
    "rcpsp-max": "irc.frontends.exporters.projects:write_rcpsp_max",
    "patterson": "irc.frontends.exporters.projects:write_patterson",
    "job-shop": "irc.frontends.exporters.shops:write_job_shop",
    "flexible-job-shop": "irc.frontends.exporters.shops:write_flexible_job_shop",
    "ms-project": "irc.frontends.ms_project.writer:write_ms_project",
}
"""The formats that tasks are written in as text, and their `Exporter`s, loaded when needed."""

PlanExporter = Callable[[Task, Schedule, bool], str]
"""(task, its schedule, whether it is kept as a baseline) → the schedule in another format."""

PLAN_EXPORTERS: Mapping[str, str] = {
    "ms-project": "irc.frontends.ms_project.planned:write_planned_project",
    "icalendar": "irc.frontends.exporters.icalendar:write_icalendar",
}
"""The formats that schedules are written in, and their `PlanExporter`s, loaded when needed."""

PLANNER = "planner"
"""The JSON of a Planner: steps, dependencies and a makespan."""

SCHEDULE_SPEC = "schedule-spec"
"""The JSON of a CP-SAT formalizer: actions with stations and robots, dependencies."""

PLAN_LINES = "plan-lines"
"""Lines such as `0: (cut apple) [3]`; what is written is a schedule."""

PDDL = "pddl"
"""The format with two files, a domain and a problem, for one task."""

MS_PROJECT = "ms-project"
"""A project of MS Project as XML (`.xml`), for one task."""

TABLES = "tables"
"""Sheets of a workbook (`.xlsx`), or CSV files, for one task."""

PDDL_PLAN, SCHEDULE = "pddl-plan", "schedule"
"""A plan of an original PDDL problem as a schedule, and the way back."""

FORMATS = (
    "irc",
    *IMPORTERS,
    PLANNER,
    SCHEDULE_SPEC,
    PLAN_LINES,
    TABLES,
    MS_PROJECT,
    PDDL,
    PDDL_PLAN,
    SCHEDULE,
)

TARGET_FORMATS = ("irc", *EXPORTERS, "icalendar", TABLES)
"""The formats that tasks are written in."""

SUFFIXES: Mapping[str, tuple[str, ...]] = {
    "psplib": (".sm", ".mm"),
    "rcpsp-max": (".sch",),
    "patterson": (".rcp",),
    "job-shop": (".jsp", ".txt"),
    "flexible-job-shop": (".fjs",),
    "ms-project": (".xml",),
    "icalendar": (".ics",),
}
"""The suffixes of a format's files, for those that are not `.json`."""

KNOWN_SUFFIXES: Mapping[str, str] = {
    ".xlsx": TABLES,
    ".csv": TABLES,
    **{one: name for name, suffixes in SUFFIXES.items() for one in suffixes if one != ".txt"},
}
"""The format of each suffix that belongs to one format alone."""

DSL_SUFFIX = ".irc"
"""The suffix of a file in the DSL; every other file is written as JSON."""


def format_of(file: str | Path) -> str:
    """The input format that a file's suffix names; `irc` where it names none."""
    return KNOWN_SUFFIXES.get(Path(file).suffix.lower(), "irc")


def load_importer(source: str) -> Importer:
    """The importer of a format in `IMPORTERS`."""
    module, _, function = IMPORTERS[source].partition(":")
    importer: Importer = getattr(import_module(module), function)
    return importer


def load_exporter(target: str) -> Exporter:
    """The exporter of a format in `EXPORTERS`."""
    module, _, function = EXPORTERS[target].partition(":")
    exporter: Exporter = getattr(import_module(module), function)
    return exporter


def load_plan_exporter(target: str) -> PlanExporter:
    """The exporter of a format in `PLAN_EXPORTERS`."""
    module, _, function = PLAN_EXPORTERS[target].partition(":")
    exporter: PlanExporter = getattr(import_module(module), function)
    return exporter
