"""`python -m irc.diagnostics.catalogue` prints the page of all diagnostics, docs/diagnostics.md."""

from __future__ import annotations

import sys

from irc.diagnostics.catalogue.page import diagnostics_page

sys.stdout.buffer.write(diagnostics_page().encode())
