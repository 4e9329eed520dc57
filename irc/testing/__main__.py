"""`python -m irc.testing TARGET [--strict]`: the conformance suite for an installed backend."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from irc.outcome import EXIT_STATUS, FAULTY, MISUSED
from irc.targets import UnknownTarget, get_backend
from irc.testing.conformance import PATIENCE, conformance_report


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the report. The exit status is 1 where the backend does not pass."""
    parser = argparse.ArgumentParser(
        prog="python -m irc.testing", description="Takes a backend through the conformance suite."
    )
    parser.add_argument("target", help="the name of an installed backend")
    parser.add_argument("--engine", help="ask only this engine")
    parser.add_argument(
        "--seconds", type=float, default=PATIENCE, help="seconds for each case and engine"
    )
    parser.add_argument(
        "--strict", action="store_true", help="fail if an engine is missing, or nothing was solved"
    )
    parser.add_argument("--verbose", action="store_true", help="print every result")
    options = parser.parse_args(arguments)
    try:
        backend = get_backend(options.target)
        if options.engine is not None:
            backend.engine(options.engine)
    except UnknownTarget as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_STATUS[MISUSED]
    report = conformance_report(backend, options.seconds, engine=options.engine)
    for result in report.results if options.verbose else ():
        print(f"{result.kind}: {result}")
    print(report)
    return 0 if report.passes(strict=options.strict) else EXIT_STATUS[FAULTY]


if __name__ == "__main__":
    sys.exit(main())
