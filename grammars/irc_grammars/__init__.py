"""The Lark grammars of the project, as text: the readers decide how to parse with them."""

from __future__ import annotations

from importlib.resources import files

__all__ = ["read_grammar"]


def read_grammar(name: str) -> str:
    """The text of the grammar `name`.lark. Raises `FileNotFoundError` for one there is not."""
    return files(__name__).joinpath(f"{name}.lark").read_text(encoding="utf-8")
