"""The commands. Each imports its modules when it runs, so that the program starts quickly."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irc.cli.asking import ask
from irc.cli.batch import batch
from irc.cli.exit_codes import EXIT_ENGINE, EXIT_INPUT, EXIT_STATUSES, EXIT_USE
from irc.cli.generate import generate
from irc.cli.new import new
from irc.cli.online import replan, run, simulate
from irc.cli.options import (
    BaselineOption,
    FileArgument,
    FileOutOption,
    FormatOption,
    OutOption,
    PlanToWriteOption,
    ProblemOption,
    TimesOption,
)
from irc.cli.output import (
    CheckFormat,
    Format,
    fail,
    print_notes,
    put,
    put_json,
    reporting_errors,
    say,
)
from irc.cli.show import show
from irc.cli.solve import print_reading_notes, solve

if TYPE_CHECKING:
    from irc.frontends.files import Reading
    from irc.targets import Program


def build_app(only: str | None = None) -> typer.Typer:
    """The command line application; with only one command if its name is given.

    Typer reads the signature of every command, which takes time, so only one is registered.
    """
    app = typer.Typer(
        name="irc",
        help="A solver-neutral compiler for asynchronous tasks.",
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
        epilog=EXIT_STATUSES,
    )
    app.callback(invoke_without_command=False)(_root)
    commands = {function.__name__.rstrip("_").replace("_", "-"): function for function in _COMMANDS}
    for name, function in commands.items():
        if only not in commands or name == only:
            app.command(name, epilog=EXIT_STATUSES)(function)
    if only not in commands:
        from irc.cli.eval import eval_app

        app.add_typer(eval_app, name="eval")
    return app


def options_of_commands() -> dict[str, frozenset[str]]:
    """The names of the options of each command, as its function has them."""
    group = typer.main.get_group(build_app())
    return {
        name: frozenset(str(p.name) for p in command.params if p.param_type_name == "option")
        for name, command in group.commands.items()
        if name != "eval"
    }


def _version(wanted: bool) -> None:
    if wanted:
        from irc._version import __version__

        put(f"irc {__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool,
        typer.Option("--version", "-V", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Compile an asynchronous task for a solver, and turn its answer into a validated schedule."""


def _read(file: str, problem: str | None = None) -> Reading:
    from irc.frontends.files import read_task

    return read_task(file, problem)


def check(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...", help="Tasks: JSON, the DSL, or English; '-' is standard input."
        ),
    ],
    format: Annotated[CheckFormat, typer.Option("--format", help="The format of the output.")] = (
        CheckFormat.text
    ),
    fix: Annotated[
        bool,
        typer.Option("--fix", help="Make all certain repairs in place, then report the rest."),
    ] = False,
) -> None:
    """Report every error, warning and note of a task in one run."""
    from irc.cli.check import check_files

    check_files(files, format, fix)


def explain_code(
    code: Annotated[
        str | None, typer.Argument(help="A code, such as IRC201. Without it: a list of all codes.")
    ] = None,
    format: FormatOption = Format.text,
) -> None:
    """Explain a diagnostic, with one input that triggers it and one that does not."""
    from irc.cli.explain_code import put_code, put_codes

    if code is None:
        put_codes(format)
    else:
        put_code(code, format)


def compile_(
    file: FileArgument,
    target: Annotated[str, typer.Option("--target", "-t", help="cpsat, pddl21, …")],
    problem: ProblemOption = None,
    output: OutOption = None,
    format: FormatOption = Format.text,
) -> None:
    """Write the program of a task for a target, and its manifest.json; without -o print it."""
    from irc.driver.compile import compile_task
    from irc.driver.files import require_folder
    from irc.targets import MANIFEST_FILE

    with reporting_errors(format):
        require_folder(output)
        reading = _read(file, problem)
        program = compile_task(reading.task, target)
        print_reading_notes(reading, format)
        print_notes(program.notes)
        if output is not None:
            from irc.driver.files import write_folder

            write_folder(output, {**program.files, MANIFEST_FILE: program.manifest_text()})
            listed = [*program.files, MANIFEST_FILE]
            if format is Format.json:
                put_json({"target": target, "folder": str(output), "files": listed})
            else:
                say(f"wrote {', '.join(listed)} to {output}")
        elif format is Format.json:
            put_json({"target": target, "files": program.files, "manifest": program.manifest})
        else:
            _print_files(program)


def _print_files(program: Program) -> None:
    for name, text in program.files.items():
        put(f"; {name}\n{text}" if len(program.files) > 1 else text)


def explain(
    file: FileArgument,
    time_limit: Annotated[
        float, typer.Option(min=0.01, max=1e9, help="Wall-clock seconds for the whole explanation.")
    ] = 60.0,
    problem: ProblemOption = None,
    why: Annotated[
        str | None,
        typer.Option("--why", help="An action or a group: why it is late, and what would help."),
    ] = None,
    times: TimesOption = None,
    format: FormatOption = Format.text,
) -> None:
    """Show why a task has no schedule, why its schedule is not shorter, or why an order is late."""
    from irc.cli.explain import put_explanation, put_lateness
    from irc.cli.interruption import INTERRUPTION
    from irc.cli.times import require_times
    from irc.driver.compile import notes_on
    from irc.explanation import explain_lateness, explain_task

    with reporting_errors(format), INTERRUPTION.planning() as cancel:
        reading = _read(file, problem)
        require_times(reading.task, times)
        spent = INTERRUPTION.spent(file)
        if why is not None:
            lateness = explain_lateness(reading.task, why, time_limit, cancel=cancel, spent=spent)
            print_reading_notes(reading, format)
            put_lateness(lateness, format, times)
            return
        explanation = explain_task(reading.task, time_limit, cancel=cancel, spent=spent)
        print_reading_notes(reading, format)
        print_notes(notes_on(reading.task))
        put_explanation(explanation, format, times)


def extract(
    manifest: Annotated[
        str, typer.Argument(help="The manifest.json of a compiled task, or a PDDL domain.")
    ],
    answer: Annotated[str, typer.Argument(help="The engine's output; '-' is standard input.")],
    problem: ProblemOption = None,
    times: TimesOption = None,
    output: FileOutOption = None,
    format: FormatOption = Format.text,
) -> None:
    """Turn an engine's raw output into an exact, validated schedule of the task.

    With --problem the output is a plan of a PDDL domain, by whichever planner.
    """
    from irc.cli.plans import extracted
    from irc.cli.solve import show_answer
    from irc.reporting.files import require_output

    with reporting_errors(format):
        if manifest == answer == "-":
            fail(EXIT_USE, "only one of the two can be standard input", format)
        require_output(output)
        show_answer(extracted(manifest, answer, problem), output, times, format)


def validate(
    file: FileArgument,
    schedule: Annotated[
        str,
        typer.Argument(help="A schedule as JSON, or a plan of a PDDL domain; '-': standard input."),
    ],
    problem: ProblemOption = None,
    at: Annotated[
        str | None,
        typer.Option("--at", help="Actions that began before this time are history: 5, '2 min', …"),
    ] = None,
    times: TimesOption = None,
    format: FormatOption = Format.text,
) -> None:
    """Check a schedule against the rules of docs/semantics.md, and name every violation."""
    from irc.cli.moments import moment_of
    from irc.cli.plans import read_schedule
    from irc.cli.times import dates_of
    from irc.cli.verdict import verdict_text
    from irc.driver.judge import validate_schedule

    with reporting_errors(format):
        if file == schedule == "-":
            fail(EXIT_USE, "only one of the two can be standard input", format)
        reading = _read(file, problem)
        answer, source = read_schedule(schedule, reading.task)
        moment = None if at is None else moment_of(reading.task, at, format)
        dates = dates_of(reading.task, times, [0, answer.makespan])
        verdict = validate_schedule(reading.task, answer, source, at=moment)
        if format is Format.json:
            put_json(verdict.to_dict())
        else:
            put(verdict_text(verdict, dates))
        if not verdict.valid:
            sys.exit(EXIT_INPUT)


def convert(
    file: Annotated[str, typer.Argument(help="The input: a file, a folder of instances, or '-'.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="The file to write, or the folder for many.")
    ],
    source: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="The format of the input: irc, asyncplan, robo, robo-online, robotouille, psplib, "
            "rcpsp-max, patterson, pyjobshop, job-shop, flexible-job-shop, planner, "
            "schedule-spec, plan-lines, tables, ms-project, pddl, pddl-plan, schedule. Without it, "
            "the suffix "
            "says which.",
        ),
    ] = None,
    target: Annotated[
        str | None,
        typer.Option(
            "--to",
            help="The format of the output: irc, psplib, rcpsp-max, patterson, job-shop, "
            "flexible-job-shop, tables, ms-project, icalendar. Without it, the suffix of the "
            "output says which.",
        ),
    ] = None,
    problem: Annotated[
        str | None, typer.Option("--problem", help="The problem file for a PDDL domain.")
    ] = None,
    instance: Annotated[
        str | None, typer.Option("--instance", help="The kitchen of a schedule-spec.")
    ] = None,
    station: Annotated[
        list[str] | None,
        typer.Option("--station", help="A capacity for a schedule-spec, such as grill=2."),
    ] = None,
    domain: Annotated[
        str | None, typer.Option("--domain", help="The domain file of a plan or a schedule.")
    ] = None,
    lenient: Annotated[
        bool, typer.Option("--lenient", help="Read PDDL as language models write it.")
    ] = False,
    schedule: PlanToWriteOption = None,
    baseline: BaselineOption = False,
    format: FormatOption = Format.text,
) -> None:
    """Write a task as IR JSON, in the DSL if the output file ends in .irc, or in another format.

    An importer writes one task for each instance into a folder.
    """
    from irc.frontends.convert import Beside, ConversionUseError, convert_file

    with reporting_errors(format):
        try:
            stations = tuple(station or ())
            beside = Beside(problem, instance, stations, domain, lenient, schedule, baseline)
            written = convert_file(
                file,
                source,
                output,
                beside,
                target=target,
                on_report=lambda report: print_notes(report, report.source),
            )
        except ConversionUseError as error:
            fail(EXIT_USE, str(error), format)
        if format is Format.json:
            put_json({"written": [str(path) for path in written]})
        else:
            where = str(written[0]) if len(written) == 1 else f"{len(written)} tasks to {output}"
            say(f"wrote {where}")


def fmt(
    file: Annotated[
        str, typer.Argument(help="A task; '-' reads standard input and writes standard output.")
    ],
    check: Annotated[
        bool, typer.Option("--check", help="Only report whether the file would change (status 1).")
    ] = False,
    format: FormatOption = Format.text,
) -> None:
    """Rewrite a task file in the standard layout of its language; its meaning stays the same."""
    from irc.frontends.layout import lay_out_file
    from irc.frontends.texts import STANDARD_INPUT

    with reporting_errors(format):
        found = lay_out_file(file, check=check)
        if format is Format.json:
            put_json({"file": file, "changed": found.changed, "text": found.laid_out})
        elif check:
            say(f"{file} would change" if found.changed else f"{file} is in order")
        elif file == STANDARD_INPUT:
            put(found.laid_out)
        else:
            say(f"{file} {'changed' if found.changed else 'was in order'}")
        if check and found.changed:
            sys.exit(EXIT_INPUT)


def targets(
    file: Annotated[
        str | None, typer.Argument(help="A task, to see which targets support it.")
    ] = None,
    format: FormatOption = Format.text,
) -> None:
    """Show which features each target supports, and why a target refuses a file."""
    from irc.cli.targets import put_targets
    from irc.driver.compile import later_events

    with reporting_errors(format):
        reading = None if file is None else _read(file)
        put_targets(None if reading is None else reading.task, format)
        if reading is not None:
            print_notes(later_events(reading.task))


def prepare() -> None:
    """Compile local search now (extra `fast`), so that no first task has to wait for it."""
    from irc.cli.prepare import compile_searches
    from irc.local_search.compiled import IS_COMPILED

    if not IS_COMPILED:
        message = "there is no llvmlite to compile with: pip install 'irc-compiler[fast]'"
        fail(EXIT_ENGINE, message, Format.text)
    for name, seconds in compile_searches():
        say(f"{name}: {seconds:.1f} s")


def schema(
    strict: Annotated[
        bool,
        typer.Option("--strict", help="For structured output of language models: closed, small."),
    ] = False,
    event: Annotated[
        bool, typer.Option("--event", help="With --strict: of one event that revises a task.")
    ] = False,
) -> None:
    """Print the JSON Schema of the IR."""
    from irc.model import Task

    if strict:
        from irc.model.strict_schema import strict_schema

        put(json.dumps(strict_schema("event" if event else "task"), separators=(",", ":")))
        return
    if event:
        fail(EXIT_USE, "--event is for --strict", Format.text)
    document = Task.model_json_schema(by_alias=True)
    put_json({"$schema": "https://json-schema.org/draft/2020-12/schema", **document})


def lsp() -> None:
    """Run the language server for an editor, over standard input and output."""
    from irc.cli.lsp import run_server

    run_server()


def mcp() -> None:
    """Run the MCP server for agents, over standard input and output: check, solve, explain, …"""
    from irc.cli.mcp import run_server

    run_server()


_COMMANDS = (
    check,
    compile_,
    solve,
    batch,
    explain,
    extract,
    validate,
    show,
    replan,
    simulate,
    run,
    convert,
    generate,
    new,
    fmt,
    explain_code,
    targets,
    prepare,
    schema,
    ask,
    lsp,
    mcp,
)
