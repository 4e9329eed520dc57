"""Pages of the site that are not files of docs/: README, examples, commands, the Python API.

MkDocs calls `on_files` and `on_page_markdown` (mkdocs.yml names this module). Nothing is written
beside the sources. Set IRC_SITE_SOLVE=0 to leave out the answers to the examples.
"""

from __future__ import annotations

import json
import os
import posixpath
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
NOTEBOOKS = ROOT / "docs" / "notebooks"

COPIES = {
    "README.md": "index.md",
    "CHANGELOG.md": "changes.md",
    "CONTRIBUTING.md": "contributing.md",
    "benchmarks/README.md": "measurements.md",
    "examples/README.md": "examples/index.md",
}
"""Files of the repository and the pages that they become."""

LINK = re.compile(r"(?<!`)\]\(([^)\s:#]+)(#[^)\s]*)?\)")
LANGUAGES = {".irc": "text", ".json": "json", ".txt": "text", ".pddl": "lisp"}
SOLVE_SECONDS = 10.0


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """The files of the site with those that are made here."""
    solved = os.environ.get("IRC_SITE_SOLVE", "1") != "0"
    answers = {example: _answer(example) for example in _examples()} if solved else {}
    made = {page: _copied(source, page) for source, page in COPIES.items()}
    made["examples/index.md"] += "\n".join(["", *(_gallery(answers) if solved else ())])
    for example in _examples():
        answer = answers.get(example)
        made[_example_page(example)] = _example(example, answer)
        if answer is not None and answer.svg is not None and answer.report is not None:
            made[f"examples/{example.stem}.svg"] = answer.svg
            made[f"examples/{example.stem}.report.html"] = answer.report
    for notebook in sorted(NOTEBOOKS.glob("*.ipynb")):
        made[f"notebooks/{notebook.stem}.md"] = "\n".join(_notebook(notebook))
    made["reference/commands.md"] = "\n".join(_commands())
    made["reference/api.md"] = "\n".join(_api())
    for page, text in made.items():
        files.append(File.generated(config, page, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """A page of docs/, whose links to other files of the repository lead to their pages."""
    if page.file.generated_by:
        return markdown
    return _relinked(markdown, f"docs/{page.file.src_uri}", page.file.src_uri)


def _copied(source: str, page: str) -> str:
    return _relinked((ROOT / source).read_text("utf-8"), source, page)


def _relinked(text: str, source: str, page: str) -> str:
    """A Markdown text with its links as they are from a page; those that lead out become text."""

    def link(match: re.Match[str]) -> str:
        there = posixpath.normpath(posixpath.join(posixpath.dirname(source), match[1]))
        target = _page_of(there)
        if target is None:
            return f"]({_OUT})"
        where = posixpath.relpath(target, posixpath.dirname(page) or ".")
        return f"]({where}{match[2] or ''})"

    linked = LINK.sub(link, text)
    return re.sub(rf"!?\[([^\]]*)\]\({_OUT}\)", r"\1", linked)


_OUT = "out-of-the-site"


def _page_of(path: str) -> str | None:
    """The page or file of the site for a file of the repository; None where there is none."""
    if path in COPIES:
        return COPIES[path]
    if f"{path}/README.md" in COPIES:
        return COPIES[f"{path}/README.md"]
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    example = ROOT / path
    return _example_page(example) if example in _examples() else None


# --- examples ---


def _examples() -> list[Path]:
    return sorted(p for p in EXAMPLES.iterdir() if p.suffix in (".json", ".txt", ".irc"))


def _example_page(example: Path) -> str:
    return f"examples/{example.stem}.md"


@dataclass(frozen=True)
class Answer:
    """The answer to an example: as text, as a picture and as a report, if there is a schedule."""

    text: str
    svg: str | None = None
    report: str | None = None


def _example(example: Path, answer: Answer | None) -> str:
    """The page of an example: its picture, its text, and the answer to it."""
    name = f"examples/{example.name}"
    title = example.stem.replace("_", " ")
    shown = [f"# {title}", ""]
    if answer is not None and answer.svg is not None:
        shown += [f"![The Gantt chart of {title}]({example.stem}.svg)", ""]
    text = example.read_text("utf-8").rstrip("\n")
    shown += [f'```{LANGUAGES[example.suffix]} title="{name}"', text, "```", ""]
    if answer is not None:
        shown += [f"`irc solve {name}` answers:", "", "```text", answer.text, "```", ""]
    if answer is not None and answer.report is not None:
        link = f"[the report]({example.stem}.report.html)"
        shown += [f"`irc solve {name} -o {example.stem}.html` writes {link}.", ""]
    return "\n".join(shown)


def _answer(example: Path) -> Answer:
    """The best answer within a few seconds. An example without a schedule says why."""
    import irc
    from irc.reporting.analysis import analyse
    from irc.reporting.charts import picture
    from irc.reporting.gantt import gantt
    from irc.reporting.html import report_html

    task = irc.load(example).ir
    schedule = irc.solve(task, time_limit=SOLVE_SECONDS)
    if not schedule.answered:
        return Answer(str(irc.explain(task, time_limit=SOLVE_SECONDS)))
    svg = picture(gantt(analyse(task, schedule)), "svg").decode("utf-8")
    return Answer(str(schedule), svg, report_html(task, schedule))


def _gallery(answers: dict[Path, Answer]) -> Iterator[str]:
    """The pictures of the examples, each with a link to its page."""
    yield "## Gallery"
    yield ""
    for example, answer in answers.items():
        if answer.svg is not None:
            title = example.stem.replace("_", " ")
            yield f"### [{title}]({example.stem}.md)"
            yield ""
            yield f"[![The Gantt chart of {title}]({example.stem}.svg)]({example.stem}.md)"
            yield ""


def _notebook(path: Path) -> Iterator[str]:
    """The cells of an executed notebook, with what they print and show."""
    for cell in json.loads(path.read_text("utf-8"))["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            yield f"{source}\n"
            continue
        yield f"```python\n{source}\n```\n"
        for output in cell["outputs"]:
            data = output.get("data", {})
            if "text/html" in data:
                # (A blank line would end the HTML.)
                lines = "".join(data["text/html"]).splitlines()
                yield "<div>" + "\n".join(line for line in lines if line.strip()) + "</div>\n"
            elif text := "".join(output.get("text", data.get("text/plain", []))):
                yield f"```text\n{text.rstrip()}\n```\n"
    yield f"[The notebook as a file]({path.name})"


# --- references ---


def _commands() -> Iterator[str]:
    """Every command with all of its arguments and options, as its own help text shows them."""
    from irc.cli.app import build_app

    app = build_app()
    yield "# Commands"
    yield ""
    yield "Every command with all of its options, as `--help` shows them. "
    yield "[The command line](../command-line.md) has what holds for all of them."
    yield ""
    yield from _command(app, [])
    for name in sorted(_names(app)):
        yield from _command(app, [name])
    for group in app.registered_groups:
        if group.typer_instance is not None and isinstance(group.name, str):
            yield from _command(app, [group.name])
            for name in sorted(_names(group.typer_instance)):
                yield from _command(app, [group.name, name])


def _names(app: Any) -> Iterator[str]:
    for command in app.registered_commands:
        if not command.hidden:
            yield command.name or command.callback.__name__.rstrip("_").replace("_", "-")


def _command(app: Any, names: list[str]) -> Iterator[str]:
    from typer.testing import CliRunner

    plain = {"COLUMNS": "96", "TERM": "dumb", "NO_COLOR": "1"}
    done = CliRunner().invoke(app, [*names, "--help"], env=plain)
    if done.exit_code:
        raise RuntimeError(f"`irc {' '.join(names)} --help` fails: {done.output}")
    yield f"## {' '.join(['irc', *names])}"
    yield ""
    yield f"```text\n{done.output.strip()}\n```"
    yield ""


def _api() -> Iterator[str]:
    """Every public name of `irc`, with the docstring of what it is."""
    import irc

    yield "# Python API"
    yield ""
    yield "Every name that `import irc` offers. [From Python](../python.md) shows them at work."
    yield ""
    for name in sorted(irc.__all__, key=str.lower):
        item = getattr(irc, name)
        module = getattr(item, "__module__", None)
        if module is None or not module.startswith("irc") or not hasattr(item, "__qualname__"):
            continue
        yield f"::: {module}.{item.__qualname__}"
        yield ""
