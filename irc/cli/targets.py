"""`irc targets`: the features that each target supports, and why a target refuses a file."""

from __future__ import annotations

from typing import Any

from irc.cli.output import Format, put, put_json
from irc.diagnostics.source import pointer_text
from irc.model import Task
from irc.model.features import Feature, features_of
from irc.targets import Backend, backends, refused_features


def put_targets(task: Task | None, format: Format) -> None:
    """Prints a table of features by target; for a task only its features, with each refusal."""
    found = backends()
    used = list(Feature)
    if task is not None:
        present = {use.feature for use in features_of(task)}
        used = [f for f in Feature if f in present]
    if format is Format.json:
        put_json({name: _as_json(b, used, task) for name, b in found.items()})
        return
    width = max((len(f.value) for f in used), default=0)
    lines = [f"{'':{width}}  " + "  ".join(found)]
    for feature in used:
        marks = "  ".join(
            ("yes" if feature in b.supports else "no").ljust(len(name)) for name, b in found.items()
        )
        lines.append(f"{feature.value:{width}}  {marks}".rstrip())
    lines.append("")
    lines += [_engines(b) for b in found.values()]
    if task is not None:
        for backend in found.values():
            lines += ["", *_verdict(task, backend)]
    put("\n".join(lines))


def _as_json(backend: Backend, used: list[Feature], task: Task | None) -> dict[str, Any]:
    shown: dict[str, Any] = {
        "features": {f.name.lower(): f in backend.supports for f in used},
        "engines": {
            name: {"available": (reason := e.missing()) is None, "reason": reason}
            for name, e in backend.engines().items()
        },
    }
    if task is not None:
        refused = refused_features(task, backend)
        shown["supports_file"] = not refused
        shown["refused"] = [
            {"feature": f.name.lower(), "pointer": pointer_text(use.pointer)}
            for f, use in refused.items()
        ]
    return shown


def _engines(backend: Backend) -> str:
    states = [
        name if e.missing() is None else f"{name} (missing)"
        for name, e in backend.engines().items()
    ]
    return f"engines of {backend.name}: {', '.join(states)}"


def _verdict(task: Task, backend: Backend) -> list[str]:
    refused = refused_features(task, backend)
    if not refused:
        return [f"{backend.name} supports this file"]
    return [f"{backend.name} does not support this file:"] + [
        f"  {use.element} ({pointer_text(use.pointer)}): {feature.value}"
        for feature, use in refused.items()
    ]
