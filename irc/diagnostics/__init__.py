"""Diagnostics: in, what a stage found; out, findings with code, place and hint, as text or JSON."""

from irc.diagnostics.finding import DIAGNOSTICS_VERSION, Code, Diagnostic, Severity
from irc.diagnostics.report import Findings, InputError, Report
from irc.diagnostics.suggest import did_you_mean

__all__ = [
    "DIAGNOSTICS_VERSION",
    "Code",
    "Diagnostic",
    "Findings",
    "InputError",
    "Report",
    "Severity",
    "did_you_mean",
]
