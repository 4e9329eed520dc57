"""Defaults of options from a file: `irc.toml`, or `[tool.irc]` in `pyproject.toml`.

The nearest folder upwards that has one of them counts, and in it `irc.toml` first. A table of the
name of a command holds its options; what stands outside of tables is for every command that has an
option of that name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from irc.errors import OptionError

Defaults = dict[str, dict[str, Any]]
"""By command, by parameter, a value."""

_NOT_SET_HERE = frozenset(["output", "help", "version", "format"])
"""Options that say what one call is to do, and are never set for all."""


def settings_file(start: Path) -> tuple[Path, Mapping[str, Any]] | None:
    """The nearest file with settings, and these. Raises `OptionError` for a file with faults."""
    for folder in (start, *start.parents):
        for name in ("irc.toml", "pyproject.toml"):
            path = folder / name
            if not path.is_file():
                continue
            found = _read(path)
            if name == "pyproject.toml":
                tool = found.get("tool")
                found = tool.get("irc") if isinstance(tool, dict) else None
            if isinstance(found, dict):
                return path, found
    return None


def _read(path: Path) -> Any:
    import tomllib

    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise OptionError(f"cannot read {str(path)!r}: {error}") from None


def defaults_for(
    settings: Mapping[str, Any], options: Mapping[str, frozenset[str]], path: Path
) -> Defaults:
    """The defaults of each command, given the names of its options.

    Raises `OptionError` for a name that no command, or not that command, has.
    """
    found: Defaults = {command: {} for command in options}
    for key, value in settings.items():
        if isinstance(value, dict):
            if key not in options:
                raise _unknown(f"command {key!r}", key, options, path)
            for name, own in value.items():
                parameter = _parameter(name)
                if parameter not in options[key] or parameter in _NOT_SET_HERE:
                    raise _unknown(f"option {name!r} of {key}", name, options[key], path)
                found[key][parameter] = own
            continue
        parameter = _parameter(key)
        users = [command for command, names in options.items() if parameter in names]
        if not users or parameter in _NOT_SET_HERE:
            known = frozenset(name for names in options.values() for name in names)
            raise _unknown(f"option {key!r}", key, known, path)
        for command in users:
            found[command].setdefault(parameter, value)
    return found


def _parameter(name: str) -> str:
    return name.replace("-", "_")


def _unknown(what: str, name: str, known: Any, path: Path) -> OptionError:
    from irc.diagnostics import did_you_mean

    options = sorted(_spelled(known))
    hint = did_you_mean(name.replace("_", "-"), options) or f"known are {', '.join(options)}"
    return OptionError(f"{path}: there is no {what}; {hint}")


def _spelled(known: Any) -> Iterator[str]:
    for name in known:
        if name not in _NOT_SET_HERE:
            yield name.replace("_", "-")
