"""`irc eval`: recorded answers scored, one's own answers scored, two tasks compared."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from irc.cli.exit_codes import EXIT_INPUT
from irc.cli.options import FormatOption
from irc.cli.output import Format, put, put_json, reporting_errors
from irc.evaluation.grid import Layout
from irc.evaluation.score import ScoredMethod
from irc.evaluation.tables import Rules

eval_app = typer.Typer(
    name="eval", help="Score recorded answers of language models.", no_args_is_help=True
)

LayoutOption = Annotated[Layout, typer.Option("--format", help="How to answer.")]


@eval_app.command("reproduce")
def reproduce_tables(
    data: Annotated[Path, typer.Option("--data", help="The folder with instances and answers.")],
    rules: Annotated[
        Rules, typer.Option("--rules", help="The paper's rules, those by meaning, or both.")
    ] = Rules.both,
    format: LayoutOption = Layout.text,
    figure: Annotated[
        Path | None, typer.Option("--figure", help="Write accuracy by size as SVG.")
    ] = None,
) -> None:
    """Compute the paper's tables again from its recorded answers; no model is called."""
    from irc.driver.files import require_file
    from irc.evaluation.data import Data
    from irc.evaluation.plot import accuracy_by_size
    from irc.evaluation.report import reproduce, written

    with reporting_errors(_plain(format)):
        require_file(figure, (".svg",))
        found = reproduce(Data(data), rules)
        put(written(found, format))
        if figure is not None:
            from irc.driver.files import write_whole

            write_whole(figure, accuracy_by_size(found.tables))


def _plain(layout: Layout) -> Format:
    return Format.json if layout is Layout.json else Format.text


@eval_app.command("score")
def score_answers(
    method: Annotated[ScoredMethod, typer.Option("--method", help="How the answers are written.")],
    instances: Annotated[
        Path, typer.Option("--instances", help="AsyncPlan-XXL, or Robo Challenge: file or folder.")
    ],
    answers: Annotated[
        Path, typer.Option("--answers", help='JSON lines: {"id", "answer"}, gzip or plain.')
    ],
    format: LayoutOption = Layout.text,
) -> None:
    """Score your own answers to the instances of a file."""
    from irc.evaluation.score import score, written

    with reporting_errors(_plain(format)):
        put(written(score(method, instances, answers), format))


@eval_app.command("diff")
def diff_tasks(
    first: Annotated[str, typer.Argument(help="A task: JSON, the DSL, or English.")],
    second: Annotated[str, typer.Argument(help="Another one.")],
    format: FormatOption = Format.text,
) -> None:
    """Show where two tasks differ: order, durations, goals (status 1 where they do)."""
    from irc.evaluation.difference import difference
    from irc.frontends.files import read_task

    with reporting_errors(format):
        found = difference(read_task(first).task, read_task(second).task)
        if format is Format.json:
            put_json({"same": found.same, **found.as_json()})
        else:
            put("\n".join(found.lines()) or "the tasks mean the same")
        if not found.same:
            sys.exit(EXIT_INPUT)
