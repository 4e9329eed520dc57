"""Targets: the interfaces of backends, programs and engines; in, a `Problem`; out, an `Outcome`."""

from irc.targets.backend import MANIFEST_FILE, MANIFEST_VERSION, Backend, Engine, Program
from irc.targets.outcome import (
    EngineFailed,
    EngineMissing,
    Limits,
    ObjectiveLevel,
    OnProgress,
    Outcome,
    Progress,
    Refusal,
    UnknownTarget,
)
from irc.targets.registry import backends, get_backend, refused_features, require_support

__all__ = [
    "MANIFEST_FILE",
    "MANIFEST_VERSION",
    "Backend",
    "Engine",
    "EngineFailed",
    "EngineMissing",
    "Limits",
    "ObjectiveLevel",
    "OnProgress",
    "Outcome",
    "Program",
    "Progress",
    "Refusal",
    "UnknownTarget",
    "backends",
    "get_backend",
    "refused_features",
    "require_support",
]
