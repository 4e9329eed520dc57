"""Targets: the interfaces of backends, programs and engines; in, a `Problem`; out, an `Outcome`."""

from irc.targets.backend import MANIFEST_FILE, MANIFEST_VERSION, Backend, Engine, Program
from irc.targets.budget import Budget, Cancellation, Clock, Work
from irc.targets.exchange import Exchange, Part
from irc.targets.options import (
    USUAL_WORK,
    EngineKeywords,
    SolveKeywords,
    SolveOptions,
    read_share,
    require_seconds,
)
from irc.targets.outcome import (
    EngineFailed,
    EngineMissing,
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
    "USUAL_WORK",
    "Backend",
    "Budget",
    "Cancellation",
    "Clock",
    "Engine",
    "EngineFailed",
    "EngineKeywords",
    "EngineMissing",
    "Exchange",
    "ObjectiveLevel",
    "OnProgress",
    "Outcome",
    "Part",
    "Program",
    "Progress",
    "Refusal",
    "SolveKeywords",
    "SolveOptions",
    "UnknownTarget",
    "Work",
    "backends",
    "get_backend",
    "read_share",
    "refused_features",
    "require_seconds",
    "require_support",
]
