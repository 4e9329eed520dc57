"""Reads PDDL text as a model of unified-planning."""

from __future__ import annotations

import warnings
from importlib.util import find_spec
from typing import Any

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Source
from irc.targets import EngineMissing


def read_problem(domain: Source, problem: Source) -> Any:
    """The model of unified-planning for a domain and a problem.

    Raises `InputError` with its error message, and `EngineMissing` if it is not installed.
    """
    require_unified_planning()
    import pyparsing
    from unified_planning.environment import get_environment
    from unified_planning.exceptions import UPException
    from unified_planning.io import PDDLReader

    environment = get_environment()  # The reader makes metrics only in this one.
    environment.credits_stream = None
    strict = environment.error_used_name
    environment.error_used_name = False  # PDDL lets a type and a predicate have one name.
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            return PDDLReader(environment).parse_problem_string(domain.text, problem.text)
    except pyparsing.ParseBaseException as error:
        raise _refused(_which(error.pstr, domain, problem), error.loc, error.msg) from None
    except (
        UPException,
        SyntaxError,
        ArithmeticError,
        AssertionError,
        AttributeError,
        LookupError,
        RecursionError,
        TypeError,
        ValueError,
    ) as error:
        # The reader checks much by assertion, and gives places only in words, if at all.
        said = str(error).strip() or type(error).__name__
        message = f"{domain.name} with {problem.name}: unified-planning cannot read this: {said}"
        raise InputError(Report((Diagnostic(Code.NOT_AN_IMPORT, message),))) from None
    finally:
        environment.error_used_name = strict


def require_unified_planning() -> None:
    """Raises `EngineMissing` if the extra `up` is not installed."""
    if find_spec("unified_planning") is None:
        raise EngineMissing(
            "PDDL is read by unified-planning, which is not installed;"
            " pip install 'irc-compiler[up]'"
        )


def _which(text: str, domain: Source, problem: Source) -> Source:
    """The source that the parser was reading; it changes case and tabs, but no lengths."""
    shown = text.strip()[:200].lower()
    return domain if domain.text.strip().replace("\t", " ").lower().startswith(shown) else problem


def _refused(source: Source, offset: int, message: str) -> InputError:
    diagnostic = Diagnostic(
        Code.NOT_AN_IMPORT, f"unified-planning cannot read this: {message}", offset=offset
    )
    return InputError(Report((diagnostic,), source))
