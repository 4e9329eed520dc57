"""Replaces uses of pools by choices of their members, after the whole text is read."""

from __future__ import annotations

from collections.abc import Iterator

from irc.diagnostics import Code, did_you_mean
from irc.diagnostics.source import Source
from irc.frontends.dsl.build import Builder, Pool, PoolUse
from irc.frontends.dsl.document_parts import Sink
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.nodes import Placed

PlacedFault = tuple[Fault, Source | None]
"""A fault, and the included file that contains it."""


def resolved_pools(builder: Builder, sink: Sink, *, faulty: bool) -> Iterator[PlacedFault]:
    """Replaces uses of pools by their members; yields the faults of pools.

    With `faulty`, some statement could not be read and may have declared anything.
    """
    if not builder.pools:
        return
    declared = {resource["id"] for resource in sink.arrays["resources"]}
    yield from _clashes(builder, declared)
    if not faulty:
        yield from _unknown_members(builder, sink, declared)
    for use in builder.uses:
        pool = builder.pools.get(use.use.get("resource", ""))
        if pool is None or use.use["resource"] in declared:
            continue
        try:
            builder.expansion.take(len(pool.members), "this pool", pool.start, pool.end)
        except Fault as fault:
            yield fault, pool.source
            return
        _choose(builder, use, pool)


def _clashes(builder: Builder, declared: set[str]) -> Iterator[PlacedFault]:
    for name, pool in builder.pools.items():
        if name in declared:
            message = f"{name!r} is the name of a pool and of a resource"
            hint = "rename one of the two"
            yield Fault(Code.DSL_POOL, message, pool.start, pool.end, hint), pool.source


def _unknown_members(builder: Builder, sink: Sink, declared: set[str]) -> Iterator[PlacedFault]:
    """The faults of undeclared members of unused pools; the checks find those of used pools."""
    used = {use.use.get("resource") for use in builder.uses}
    known = declared | {
        resource["id"]
        for event in sink.arrays["events"]
        for change in event.get("changes", ())
        for resource in change.get("resources", ())
    }
    for name, pool in builder.pools.items():
        for member in () if name in used else pool.places:
            if member.value not in known:
                yield _unknown(member, known), pool.source


def _unknown(member: Placed, known: set[str]) -> Fault:
    return Fault(
        Code.UNKNOWN_NAME,
        f"there is no resource {member.value!r}",
        member.start,
        member.end,
        did_you_mean(member.value, sorted(known)) or "declare it",
    )


def _choose(builder: Builder, use: PoolUse, pool: Pool) -> None:
    amount = use.use.pop("amount", None)
    del use.use["resource"]
    use.use["one_of"] = pool.members
    if amount is not None:
        use.use["amount"] = amount
    if builder.places is not None:
        places = builder.places.found
        named = places.get((*use.pointer, "resource"))
        if named is not None:
            for i in range(len(pool.members)):
                places.setdefault((*use.pointer, "one_of", i), named)
