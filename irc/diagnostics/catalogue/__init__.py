"""The catalogue: for each diagnostic an explanation, a remedy, a bad and a good example.

The texts are in the `.toml` files beside this module, one for each family of codes.
`irc explain-code`, `docs/diagnostics.md` and the rules in SARIF are all made from them. Tests run
every example. `python -m irc.diagnostics.catalogue` prints the page.

A new code gets a table in the file of its family, or in a new file beside the others:

- `explanation`: why irc reports this, in a few sentences; `remedy`: what to do, in half a sentence.
- `bad`, `good`: a text of the file `file` (default "task.json") that triggers this code, and one
  that does not. `encoding` is that of the bad one, if it is not UTF-8.
- `output`: what irc prints about the bad one, without the summary line.
- `command`: the command of the example (default: `irc check task.json`), after the commands in
  `before`, with the further files in `files`. If `printed_by` names an engine, the example is what
  that engine prints.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

from irc.diagnostics.finding import Code


@dataclass(frozen=True)
class CatalogueEntry:
    """The catalogue's texts for one code."""

    code: Code
    explanation: str
    remedy: str
    bad: str
    output: str
    good: str
    file: str = "task.json"
    command: str = "irc check task.json"
    encoding: str = "utf-8"
    before: tuple[str, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict)
    printed_by: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc explain-code --format json` prints."""
        return {
            "code": self.code.id,
            "name": self.code.name.lower(),
            "severity": str(self.code.severity),
            "summary": self.code.summary,
            "explanation": self.explanation,
            "remedy": self.remedy,
            "bad": self.bad,
            "output": self.output,
            "good": self.good,
            "file": self.file,
            "encoding": self.encoding,
            "commands": [*self.before, self.command],
            "files": dict(self.files),
            "printed_by": self.printed_by,
        }


@dataclass(frozen=True)
class Family:
    """Codes of one subject, in the order of the documentation."""

    title: str
    about: str
    entries: tuple[CatalogueEntry, ...]


@cache
def load_families() -> tuple[Family, ...]:
    """All families in the order of their codes. Raises `ValueError` for an unknown code."""
    texts = [item.read_text("utf-8") for item in files(__name__).iterdir() if _is_data(item.name)]
    families = [_family(tomllib.loads(text)) for text in texts]
    return tuple(sorted(families, key=lambda family: family.entries[0].code.id))


@cache
def load_catalogue() -> Mapping[str, CatalogueEntry]:
    """Every entry by its code ("IRC201")."""
    return {entry.code.id: entry for family in load_families() for entry in family.entries}


def _is_data(name: str) -> bool:
    return name.endswith(".toml")


def _family(raw: Mapping[str, Any]) -> Family:
    codes = {code.id: code for code in Code}
    entries = []
    for id, fields in raw["codes"].items():
        if id not in codes:
            raise ValueError(f"the catalogue has an entry for {id}, which is not a code")
        texts = {key: " ".join(fields[key].split()) for key in _FLOWING}
        texts["output"] = fields["output"].strip()
        lists = {"before": tuple(fields.get("before", ()))}
        entries.append(CatalogueEntry(codes[id], **{**fields, **texts, **lists}))
    return Family(raw["title"], " ".join(raw["about"].split()), tuple(entries))


_FLOWING = ("explanation", "remedy")
