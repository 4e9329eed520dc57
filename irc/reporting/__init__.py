"""Reporting: in, a `Task` and a schedule of it; out, rows, tables, pictures and reports for people.

It reads the task as it was written, for names, due dates and calendars, and the exact schedule.
"""
