"""Importers of scheduling benchmarks: in, files of numbers (PSPLIB, job shops); out, IR tasks."""
