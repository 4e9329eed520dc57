"""`python -m irc.diagnostics.catalogue > docs/diagnostics.md` writes the page of all diagnostics."""

from __future__ import annotations

import sys

from irc.diagnostics.catalogue.page import diagnostics_page

sys.stdout.buffer.write(diagnostics_page().encode())
