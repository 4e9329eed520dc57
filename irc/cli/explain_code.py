"""`irc explain-code`: explains a diagnostic from the catalogue."""

from __future__ import annotations

from textwrap import fill

from irc.cli.exit_codes import EXIT_USE
from irc.cli.output import Format, fail, put, put_json
from irc.diagnostics import did_you_mean
from irc.diagnostics.catalogue import CatalogueEntry, load_catalogue, load_families

CODES_VERSION = "1"

_WIDTH = 88

_LOOKALIKES = str.maketrans("OLS", "015", "- _")


def put_code(code: str, format: Format) -> None:
    """Prints the explanation of one code: "IRC201" in upper or lower case, or its number alone."""
    entries = load_catalogue()
    id = code.strip().upper()
    id = f"IRC{id.removeprefix('IRC')}"
    if id not in entries:
        hint = (
            did_you_mean(id.translate(_LOOKALIKES), entries) or "`irc explain-code` lists them all"
        )
        fail(EXIT_USE, f"there is no diagnostic {code!r}; {hint}", format)
    if format is Format.json:
        put_json(entries[id].to_dict())
    else:
        put(_in_words(entries[id]))


def put_codes(format: Format) -> None:
    """Prints a list of all codes, a line on each."""
    if format is Format.json:
        entries = [entry.to_dict() for entry in load_catalogue().values()]
        put_json({"irc_codes": CODES_VERSION, "codes": entries})
        return
    blocks = []
    for family in load_families():
        rows = [f"  {e.code.id}  {e.code.severity:8}{e.code.summary}" for e in family.entries]
        blocks.append("\n".join([family.title, *rows]))
    put("\n\n".join([*blocks, "`irc explain-code IRC201` explains one of them."]))


def _in_words(entry: CatalogueEntry) -> str:
    code = entry.code
    parts = [f"{code.severity}[{code.id}]: {code.summary}", fill(entry.explanation, _WIDTH)]
    parts.append(fill(f"What to do: {entry.remedy}.", _WIDTH))
    for name, text in entry.files.items():
        parts.append(f"With this {name}\n\n{_indented(text)}")
    parts += [f"after `{command}`," for command in entry.before]
    source = f"printed by {entry.printed_by}" if entry.printed_by else entry.file
    saved = "" if entry.encoding == "utf-8" else f", saved as {entry.encoding.upper()}"
    parts.append(f"Bad ({source}{saved}):\n\n{_indented(entry.bad)}")
    parts.append(f"`{entry.command}` prints:\n\n{_indented(entry.output)}")
    parts.append(f"Good:\n\n{_indented(entry.good)}")
    return "\n\n".join(parts)


def _indented(text: str) -> str:
    lines = text.rstrip("\n").split("\n")
    return "\n".join(f"    {line}".rstrip() for line in lines)
