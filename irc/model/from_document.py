"""Turns a raw document into a `Task`: pydantic checks it, `shape_faults` words the faults."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from irc.diagnostics import Findings
from irc.model import Task


def to_task(
    raw: Mapping[str, Any], findings: Findings, *, null_is_absent: bool = True
) -> Task | None:
    """The typed task, or None after every fault of shape has been added to `findings`."""
    try:
        return Task.model_validate(raw)
    except ValidationError as error:
        from irc.model.nulls import without_nulls

        stripped = without_nulls(raw) if null_is_absent else raw
        if stripped is not raw:
            return to_task(stripped, findings)
        from irc.model.shape_faults import faults_in_words

        findings.items += faults_in_words(error, raw)
    return None
