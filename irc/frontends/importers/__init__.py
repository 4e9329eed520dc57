"""Importers: in, benchmark instances and planning domains; out, IR tasks."""
