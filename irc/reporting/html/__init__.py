"""The HTML report: in, a task and its schedule; out, one file that a browser shows by itself."""

from irc.reporting.html.page import ReportTooLarge, payload_of, report_html

__all__ = ["ReportTooLarge", "payload_of", "report_html"]
