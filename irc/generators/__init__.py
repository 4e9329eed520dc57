"""Generators: in, a family, a size and a seed; out, new instances with texts and gold answers."""
