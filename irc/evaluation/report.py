"""The whole report of `irc eval reproduce`: tables, outcomes, comparisons and errata."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from irc.evaluation.comparison import Comparison, all_comparisons
from irc.evaluation.data import Data
from irc.evaluation.errata import SUMMARY_ONLY, Erratum, errata
from irc.evaluation.figure import Document, Figure, Rate, Table, document, number
from irc.evaluation.grid import WRITERS, Grid, Layout, csv_text, grid_of
from irc.evaluation.outcomes import outcome_table
from irc.evaluation.paper_figures import beside, paper_figures
from irc.evaluation.scored import Scored
from irc.evaluation.statistics import interval
from irc.evaluation.tables import Rules, all_tables


@dataclass(frozen=True)
class Reproduction:
    """All that the recorded answers of a data folder give."""

    tables: Mapping[str, Table]
    outcomes: Mapping[str, Table]
    comparisons: tuple[Comparison, ...]
    errata: tuple[Erratum, ...]


def reproduce(data: Data, rules: Rules = Rules.both) -> Reproduction:
    """All tables of a data folder. Raises `InputError` naming what cannot be read."""
    scored = Scored(data)
    return Reproduction(
        all_tables(scored, rules),
        outcome_table(scored),
        tuple(all_comparisons(scored)),
        tuple(errata(data)),
    )


def interval_of(figure: Figure) -> Document:
    """The bootstrap interval of a rate; None for a count."""
    return list(interval(figure)) if isinstance(figure, Rate) else None


def written(found: Reproduction, layout: Layout) -> str:
    """The report in a layout."""
    if layout is Layout.json:
        return json.dumps(as_json(found), indent=1)
    if layout is Layout.csv:
        return csv_text({**found.tables, "outcomes": found.outcomes})
    writer = WRITERS[layout]
    return "\n\n".join(writer(grid) for grid in _grids(found)) + "\n"


def as_json(found: Reproduction) -> dict[str, Any]:
    """The report as a JSON document; `intervals` has the shape of `tables`."""
    return {
        "irc_eval": 1,
        "tables": document(found.tables, number),
        "intervals": document(found.tables, interval_of),
        "paper": {"/".join(path): value for path, value in paper_figures()},
        "outcomes": document(found.outcomes, number),
        "comparisons": [comparison.as_json() for comparison in found.comparisons],
        "errata": [erratum.as_json() for erratum in found.errata],
        "summary_only": list(SUMMARY_ONLY),
    }


def _grids(found: Reproduction) -> Iterator[Grid]:
    for name, table in found.tables.items():
        yield grid_of(name, table)
    yield beside(found.tables)
    yield grid_of("outcomes", found.outcomes)
    yield _comparison_grid(found.comparisons)
    yield Grid(
        "errata",
        ("place", "printed", "right", "why"),
        [(e.place, e.printed, e.right, e.why) for e in found.errata],
    )
    yield Grid("summary only: raw answers lost", ("runs",), [(text,) for text in SUMMARY_ONLY])


def _comparison_grid(comparisons: tuple[Comparison, ...]) -> Grid:
    columns = ("data", "measure", "model", "methods", "n", "only first", "only second", "p")
    rows = [
        (
            *(c.data, c.measure, c.model, f"{c.first}, {c.second}"),
            *(str(c.instances), str(c.only_first), str(c.only_second), f"{c.p:.3g}"),
        )
        for c in comparisons
    ]
    return Grid("comparisons: McNemar's exact test", columns, rows)
