"""Diagnostics: in, what a stage found; out, findings with code, place and hint, as text or JSON."""

from irc.diagnostics.finding import Code, Diagnostic, Severity
from irc.diagnostics.report import Findings, InputError, Report
from irc.diagnostics.suggest import did_you_mean

__all__ = [
    "Code",
    "Diagnostic",
    "Findings",
    "InputError",
    "Report",
    "Severity",
    "did_you_mean",
]
