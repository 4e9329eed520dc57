"""The catalogue as the page `docs/diagnostics.md`."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files
from textwrap import fill

from irc.diagnostics.catalogue import CatalogueEntry, Family, load_families

_LANGUAGES = {"json": "json", "irc": "text", "txt": "text"}


def diagnostics_page() -> str:
    """The whole page in Markdown: the introduction, tables of all codes, then each code."""
    families = load_families()
    lines = [files(__package__).joinpath("introduction.md").read_text("utf-8").rstrip(), ""]
    for family in families:
        lines += _table(family)
    for family in families:
        lines += [f"## {family.title}", "", fill(family.about, 100), ""]
        for entry in family.entries:
            lines += _section(entry)
    return "\n".join(lines).rstrip() + "\n"


def _table(family: Family) -> Iterator[str]:
    yield f"**{family.title}**"
    yield ""
    yield "| code | severity | meaning | what to do |"
    yield "|---|---|---|---|"
    for entry in family.entries:
        code = entry.code
        link = f"[{code.id}](#{code.id.lower()})"
        yield f"| {link} | {code.severity} | {code.summary} | {entry.remedy} |"
    yield ""


def _section(entry: CatalogueEntry) -> Iterator[str]:
    code = entry.code
    yield f"### {code.id}"
    yield ""
    yield f"*{code.severity}: {code.summary}.*"
    yield ""
    yield fill(entry.explanation, 100)
    yield ""
    yield f"What to do: {entry.remedy}."
    yield ""
    for name, text in entry.files.items():
        yield from _fenced(f"With `{name}`:", text, _language(name))
    yield from _fenced(_bad_title(entry), entry.bad, _language(entry.file))
    commands = " and then ".join(f"`{command}`" for command in (*entry.before, entry.command))
    yield from _fenced(f"{commands} prints", entry.output, "text")
    yield from _fenced("Good:", entry.good, _language(entry.file))


def _bad_title(entry: CatalogueEntry) -> str:
    if entry.printed_by is not None:
        return f"Bad, printed by the engine {entry.printed_by}:"
    saved = "" if entry.encoding == "utf-8" else f", saved as {entry.encoding.upper()}"
    return f"Bad (`{entry.file}`{saved}):"


def _fenced(title: str, text: str, language: str) -> Iterator[str]:
    yield title
    yield ""
    yield f"```{language}"
    yield text.rstrip("\n")
    yield "```"
    yield ""


def _language(file: str) -> str:
    return _LANGUAGES.get(file.rpartition(".")[2], "text")
