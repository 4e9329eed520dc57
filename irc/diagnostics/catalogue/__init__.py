"""What each diagnostic means: an explanation, what to do, a bad and a good example.

The texts stand in the `.toml` files beside this module, one for each family of codes. They are the
one source of `irc explain-code`, of `docs/diagnostics.md` and of the rules in SARIF. Tests run
every example. `python -m irc.diagnostics.catalogue` prints the page.

A new code gets a table in the file of its family (or in a new file, which is found by itself):

- `explanation`: why this is told, in a few sentences; `remedy`: what to do, in half a sentence.
- `bad`, `good`: the text of the file `file` (default "task.json") that is told this code, and that
  is not. `encoding` says how the bad one is saved where that is not UTF-8.
- `told`: what irc prints about the bad one, without the summary line.
- `command`: what is run (default: `irc check task.json`), after the commands in `before`, with the
  further files in `files`. Where `printed_by` names an engine, the example is what that prints.
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
class Entry:
    """What the catalogue says of one code."""

    code: Code
    explanation: str
    remedy: str
    bad: str
    told: str
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
            "told": self.told,
            "good": self.good,
            "file": self.file,
            "encoding": self.encoding,
            "commands": [*self.before, self.command],
            "files": dict(self.files),
            "printed_by": self.printed_by,
        }


@dataclass(frozen=True)
class Family:
    """Codes of one subject, as the documentation groups them."""

    title: str
    about: str
    entries: tuple[Entry, ...]


@cache
def load_families() -> tuple[Family, ...]:
    """All families in the order of their codes. Raises `ValueError` for a code that is none."""
    texts = [item.read_text("utf-8") for item in files(__name__).iterdir() if _is_data(item.name)]
    families = [_family(tomllib.loads(text)) for text in texts]
    return tuple(sorted(families, key=lambda family: family.entries[0].code.id))


@cache
def load_catalogue() -> Mapping[str, Entry]:
    """Every entry by its code ("IRC201")."""
    return {entry.code.id: entry for family in load_families() for entry in family.entries}


def _is_data(name: str) -> bool:
    return name.endswith(".toml")


def _family(raw: Mapping[str, Any]) -> Family:
    codes = {code.id: code for code in Code}
    entries = []
    for id, fields in raw["codes"].items():
        if id not in codes:
            raise ValueError(f"the catalogue has an entry for {id}, which is no code")
        texts = {key: " ".join(fields[key].split()) for key in _FLOWING}
        texts["told"] = fields["told"].strip()
        lists = {"before": tuple(fields.get("before", ()))}
        entries.append(Entry(codes[id], **{**fields, **texts, **lists}))
    return Family(raw["title"], " ".join(raw["about"].split()), tuple(entries))


_FLOWING = ("explanation", "remedy")
