"""Importers of other people's formats: benchmark instances and planning domains → IR tasks."""
