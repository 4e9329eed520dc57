"""Finds the installed backends, and the features of a task that each does not support."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.model import Task
from irc.model.features import Feature, FeatureUse, features_of
from irc.targets.backend import Backend
from irc.targets.outcome import UnknownTarget

_OWN = {"cpsat": ("irc_cpsat", "CpSat"), "pddl21": ("irc_pddl21", "Pddl21")}
"""irc's own backends, so that their use need not read every installed distribution."""


@cache
def backends() -> Mapping[str, Backend]:
    """All installed backends by name."""
    from importlib.metadata import entry_points

    found = sorted(entry_points(group="irc.backends"), key=lambda point: point.name)
    return {point.name: point.load()() for point in found}


def get_backend(name: str) -> Backend:
    """The backend called `name`. Raises `UnknownTarget` with a suggestion if there is none."""
    if name in _OWN:
        module, class_name = _OWN[name]
        own: Backend = getattr(import_module(module), class_name)()
        return own
    if name not in backends():
        raise UnknownTarget("target", name, list(backends()))
    return backends()[name]


def refused_features(task: Task, backend: Backend) -> dict[Feature, FeatureUse]:
    """The features of a task that a backend does not support, each with its first place."""
    refused: dict[Feature, FeatureUse] = {}
    supports = backend.supports
    for use in features_of(task):
        if use.feature not in supports:
            refused.setdefault(use.feature, use)
    return refused


def require_support(task: Task, backend: Backend) -> None:
    """Raises `InputError` for each feature that the backend does not support, with its place and
    the targets that support it.
    """
    refused = refused_features(task, backend)
    if not refused:
        return
    diagnostics = []
    for feature, use in refused.items():
        able = [b.name for b in backends().values() if feature in b.supports]
        hint = (
            f"targets that support it: {', '.join(able)}"
            if able
            else "no installed target supports it yet"
        )
        diagnostics.append(
            Diagnostic(
                Code.UNSUPPORTED,
                f"{use.element}: target {backend.name!r} does not support {feature.value}",
                use.pointer,
                hint,
            )
        )
    raise InputError(Report(tuple(diagnostics), task.source))
