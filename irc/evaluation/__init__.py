"""Evaluation: in, recorded answers and gold instances; out, the tables of figures about them."""
