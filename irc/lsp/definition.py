"""Finds the declarations of a name, in the text itself or in files that it includes."""

from __future__ import annotations

from pathlib import Path

from irc.diagnostics.source import Source
from irc.lsp.analysis import Analysis
from irc.lsp.dsl import PoolStatement, Word, included, includes, pools
from irc.lsp.mentions import Kind
from irc.lsp.names import Names, Spot


def definitions(analysis: Analysis, names: Names, offset: int, path: Path | None) -> list[Spot]:
    """The declarations of the name at an offset of the source."""
    source = analysis.source
    if source is None:
        return []
    if analysis.language == "dsl":
        found = _of_the_dsl(source, names, offset, path)
        if found:
            return found
    there = names.at(offset)
    return [] if there is None else names.declarations(there[0])


def pool_at(
    source: Source, offset: int, path: Path | None
) -> tuple[PoolStatement, Source | None] | None:
    """(the pool that is named at an offset, the included text that declares it, if any)."""
    texts: list[tuple[str, Source | None]] = [(source.text, None)]
    if path is not None:
        texts += [(i.source.text, i.source) for i in included(source.text, path)]
    for text, within in texts:
        for pool in pools(text):
            name = pool.pool.name
            if within is None and pool.pool.start <= offset <= pool.pool.end:
                return pool, None
            if _stands_at(source.text, name, offset):
                return pool, within
    return None


def _of_the_dsl(source: Source, names: Names, offset: int, path: Path | None) -> list[Spot]:
    """The declarations of names that only the DSL has: files, pools, and members of pools."""
    for name, start, end in includes(source.text):
        if start <= offset <= end and path is not None:
            return [
                Spot(0, 0, i.source)
                for i in included(source.text, path)
                if i.path == (path.parent / name).resolve()
            ]
    member = _member_at(source.text, offset)
    if member is not None:
        return list(names.declared.get((Kind.RESOURCE, member.name, None), ()))
    there = names.at(offset)
    if there is not None and any(m.declares for m in there[0]):
        return []
    named = None if there is None else source.text[there[1].start : there[1].end].strip('"')
    found = pool_at(source, offset, path)
    if found is None or (named is not None and named != found[0].pool.name):
        return []
    pool, within = found
    return [Spot(pool.pool.start, pool.pool.end, within)]


def _member_at(text: str, offset: int) -> Word | None:
    for pool in pools(text):
        for member in pool.members:
            if member.start <= offset <= member.end:
                return member
    return None


def _stands_at(text: str, name: str, offset: int) -> bool:
    """Whether a name contains an offset."""
    begin = text.find(name, max(0, offset - len(name)), offset + len(name))
    return 0 <= begin <= offset <= begin + len(name)
