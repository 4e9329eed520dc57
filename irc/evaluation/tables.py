"""The paper's tables from scored answers, under the names of docs/evaluation.md."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from enum import StrEnum

from irc.evaluation.figure import Count, Table
from irc.evaluation.row import Row, Rows, count, percents, rate
from irc.evaluation.scored import Scored
from irc.methods import AnswerState

GRAPH_FAITH = ("makespan", "dep_prec", "dep_rec", "goal", "count", "dur")
ERRORS = {
    "planner": ("missing_dep", "incomplete_goal", "wrong_dur", "no_output"),
    "pddl": ("missing_dep", "incomplete_goal", "effect_mismatch", "wrong_dur", "invalid"),
    "cpsat": ("missing_dep", "incomplete_goal", "wrong_dur", "invalid"),
}
MEANING = (
    *("m_read", "m_prec", "m_rec", "m_goal", "m_count", "m_dur"),
    *("m_plan", "m_exact", "m_dur_all", "m_goal_all"),
)
DELIVERED = ("makespan", "plan_superset", "code", "dep_rec", "dur")


class Rules(StrEnum):
    """Which rules the tables go by."""

    paper = "paper"
    meaning = "meaning"
    both = "both"


def all_tables(scored: Scored, rules: Rules = Rules.both) -> dict[str, Table]:
    """The tables by name: those that go by one kind of rules only where they are asked for."""
    return {
        name: make(scored)
        for name, (kind, make) in _TABLES.items()
        if Rules.both in (kind, rules) or kind is rules
    }


# --- AsyncPlan-XXL ------------------------------------------------------------------------------


def step_methods(scored: Scored) -> dict[str, Rows]:
    """The three methods that have runs at every size."""
    return {"planner": scored.planner, "pddl": scored.pddl, "cpsat": scored.cpsat}


def _answers(scored: Scored) -> Table:
    """The number of scored runs; those of Gold IR on CP-SAT, which irc makes, are among them."""
    methods = (step_methods, control_methods, robo_methods, online_methods, _asynchow_methods)
    return Count(sum(len(rows.rows) for of in methods for rows in of(scored).values()))


def _by_size(rows: Rows, measure: str) -> Table:
    return {
        model: {size: rate(rows.cell(model, size), measure) for size in rows.groups}
        for model in rows.models
    }


def _makespan(scored: Scored) -> Table:
    return {name: _by_size(rows, "makespan") for name, rows in step_methods(scored).items()}


def _plan_paper(scored: Scored) -> Table:
    measures = {"planner": "plan_superset", "pddl": "plan", "cpsat": "plan"}
    return _sized(scored, measures)


def _plan_meaning(scored: Scored) -> Table:
    measures = {"planner": "plan_superset", "pddl": "m_plan", "cpsat": "plan"}
    return _sized(scored, measures)


def _sized(scored: Scored, measures: Mapping[str, str]) -> Table:
    methods = step_methods(scored)
    return {name: _by_size(methods[name], measure) for name, measure in measures.items()}


def _faithfulness(scored: Scored) -> Table:
    plan = {"planner": "plan", "pddl": "plan", "cpsat": "plan_valid"}
    return {
        name: percents(rows.rows, (*GRAPH_FAITH, plan[name]))
        for name, rows in step_methods(scored).items()
    }


def _faithfulness_meaning(scored: Scored) -> Table:
    rows = scored.pddl
    by_model = {model: percents(rows.of_model(model), MEANING) for model in rows.models}
    return {**by_model, "all": percents(rows.rows, MEANING)}


def _errors(scored: Scored) -> Table:
    return {name: percents(rows.rows, ERRORS[name]) for name, rows in step_methods(scored).items()}


def _errors_by_size(scored: Scored) -> Table:
    return {
        name: {
            size: percents(rows.of_group(size), (*ERRORS[name], "dep_rec", "makespan"))
            for size in rows.groups
        }
        for name, rows in step_methods(scored).items()
    }


def has_object(row: Row) -> bool:
    """Whether a JSON object was read in the answer, be its contents in order or not."""
    return row.state in (AnswerState.OK, AnswerState.INVALID)


def _planner_answers(scored: Scored) -> Table:
    """By model: answers with a JSON object ("ok"), and those without by what became of them."""
    rows = scored.planner
    table: dict[str, Table] = {}
    for model in rows.models:
        found = dict.fromkeys(("ok", "empty", "truncated", "malformed"), 0)
        for row in rows.of_model(model):
            found["ok" if has_object(row) else row.state.value] += 1
        table[model] = {state: Count(number) for state, number in found.items() if number}
    return table


def _planner_of_delivered(scored: Scored) -> Table:
    return percents([row for row in scored.planner.rows if has_object(row)], DELIVERED)


def _reversed_edges(scored: Scored) -> Table:
    methods = {
        "planner": scored.planner,
        "cpsat": scored.cpsat,
        "direct-cpsat": scored.direct_cpsat,
        "nl-cpsat": scored.nl_cpsat,
    }
    return {
        name: {
            model: count(rows.of_model(model), lambda row: row.scores["reversed"])
            for model in rows.models
        }
        for name, rows in methods.items()
    }


def _pddl_meaning(scored: Scored) -> Table:
    rows = scored.pddl.rows
    usable = [row for row in rows if not row.overflow]
    every = ("m_exact", "m_dur_all", "m_goal_all")
    return {
        "faithful": count(rows, lambda row: all(row.scores[measure] for measure in every)),
        "n": Count(len(rows)),
        "plan_no_overflow": [
            count(usable, lambda row: row.scores["m_plan"]),
            Count(len(usable)),
        ],
    }


# --- IR control ---------------------------------------------------------------------------------


def control_methods(scored: Scored) -> dict[str, Rows]:
    """The methods of the IR control by name."""
    return {
        "direct-cpsat": scored.direct_cpsat,
        "nl-cpsat": scored.nl_cpsat,
        "gold-cpsat": scored.gold_cpsat,
        "direct-pddl": scored.direct_pddl,
        "nl-pddl": scored.nl_pddl,
        "gold-pddl": scored.gold_pddl,
    }


def _pairs(rows: Rows, measures: Iterable[str]) -> Table:
    """By model and size: the means of the measures, only where there are answers."""
    return {
        model: {
            size: [rate(cell, measure) for measure in measures]
            for size in rows.groups
            if (cell := rows.cell(model, size))
        }
        for model in rows.models
    }


def _ir_control(scored: Scored) -> Table:
    methods = control_methods(scored)
    return {name: _pairs(rows, ("makespan", "plan")) for name, rows in methods.items()}


def _service_failures(scored: Scored) -> Table:
    methods = {
        name: control_methods(scored)[name] for name in ("nl-pddl", "gold-pddl", "direct-pddl")
    }
    return {
        name: {
            model: count(rows.of_model(model), lambda row: row.service_failure)
            for model in rows.models
        }
        for name, rows in methods.items()
    }


def _nl_ir(scored: Scored) -> Table:
    """By model and size: answers, those read, those of the right makespan, and exact graphs."""
    rows = scored.nl_ir
    return {
        model: {
            size: [
                Count(len(cell)),
                *(_holding(cell, measure) for measure in _NL_IR),
            ]
            for size in rows.groups
            if (cell := rows.cell(model, size))
        }
        for model in rows.models
    }


_NL_IR = ("read", "makespan", "exact")


def _holding(rows: Iterable[Row], measure: str) -> Count:
    return count(rows, lambda row: row.scores[measure])


def _gold_pddl(scored: Scored) -> Table:
    rows = scored.gold_pddl.rows
    clean = [row for row in rows if not row.service_failure and not row.overflow]
    return {
        "n": Count(len(rows)),
        "makespan": count(rows, lambda row: row.scores["makespan"]),
        "plan": count(rows, lambda row: row.scores["plan"]),
        "service_failure": count(rows, lambda row: row.service_failure),
        "overflow": count(rows, lambda row: row.overflow),
        "clean": Count(len(clean)),
        "clean_plan": count(clean, lambda row: row.scores["plan"]),
    }


# --- kitchens -----------------------------------------------------------------------------------

Methods = Callable[[Scored], Mapping[str, Rows]]

_ROBO = ("recorded", "plan", "optimal")
_ONLINE = ("recorded", "plan", "strict", "with_deadlines")


def robo_methods(scored: Scored) -> dict[str, Rows]:
    """The methods of Robo Challenge by the paper's names."""
    return {
        "planner": scored.robo_planner,
        "formalizer": scored.robo_pddl,
        "cpsat_formalizer": scored.robo_cpsat,
    }


def online_methods(scored: Scored) -> dict[str, Rows]:
    """The methods of Online Robo Challenge by the paper's names."""
    return {
        "planner": scored.online_planner,
        "formalizer": scored.online_pddl,
        "cpsat_formalizer": scored.online_cpsat,
    }


def _online_size_methods(scored: Scored) -> dict[str, Rows]:
    """Those with the runs of all models: of the CP-SAT Formalizer one model's are left."""
    methods = online_methods(scored)
    return {name: methods[name] for name in ("planner", "formalizer")}


def _by_group(methods: Methods, measures: Iterable[str]) -> Callable[[Scored], Table]:
    def table(scored: Scored) -> Table:
        return {
            name: {group: percents(rows.of_group(group), measures) for group in rows.groups}
            for name, rows in methods(scored).items()
        }

    return table


def _by_model(methods: Methods, measures: Iterable[str]) -> Callable[[Scored], Table]:
    def table(scored: Scored) -> Table:
        return {
            name: {model: percents(rows.of_model(model), measures) for model in rows.models}
            for name, rows in methods(scored).items()
        }

    return table


def _kitchen_errors(methods: Methods) -> Callable[[Scored], Table]:
    def table(scored: Scored) -> Table:
        return {name: _error_counts(rows) for name, rows in methods(scored).items()}

    return table


def _error_counts(rows: Rows) -> Table:
    found: dict[str, int] = {}
    for row in rows.rows:
        kind = row.error or "ok"
        found[kind] = found.get(kind, 0) + 1
    return {kind: Count(number) for kind, number in sorted(found.items())}


# --- AsyncHow -----------------------------------------------------------------------------------


def _asynchow_methods(scored: Scored) -> Mapping[str, Rows]:
    return scored.asynchow


def _asynchow(scored: Scored) -> Table:
    return {
        name: {model: rate(rows.of_model(model), "makespan", 100) for model in rows.models}
        for name, rows in scored.asynchow.items()
    }


_TABLES: dict[str, tuple[Rules, Callable[[Scored], Table]]] = {
    "n": (Rules.both, _answers),
    "xxl_makespan": (Rules.both, _makespan),
    "xxl_plan_paper": (Rules.paper, _plan_paper),
    "xxl_plan_meaning": (Rules.meaning, _plan_meaning),
    "faithfulness_paper": (Rules.paper, _faithfulness),
    "faithfulness_meaning_pddl": (Rules.meaning, _faithfulness_meaning),
    "errors_paper": (Rules.paper, _errors),
    "errors_by_size": (Rules.paper, _errors_by_size),
    "planner_answers": (Rules.both, _planner_answers),
    "planner_of_delivered": (Rules.both, _planner_of_delivered),
    "reversed_edges": (Rules.both, _reversed_edges),
    "ir_control": (Rules.both, _ir_control),
    "ir_control_service_failures": (Rules.both, _service_failures),
    "robo": (Rules.both, _by_group(robo_methods, _ROBO)),
    "robo_by_model": (Rules.both, _by_model(robo_methods, _ROBO)),
    "robo_errors": (Rules.both, _kitchen_errors(robo_methods)),
    "online": (Rules.both, _by_group(_online_size_methods, _ONLINE)),
    "online_by_model": (Rules.both, _by_model(online_methods, _ONLINE)),
    "online_errors": (Rules.both, _kitchen_errors(online_methods)),
    "asynchow": (Rules.both, _asynchow),
    "nl_ir": (Rules.both, _nl_ir),
    "gold_pddl": (Rules.both, _gold_pddl),
    "pddl_meaning": (Rules.meaning, _pddl_meaning),
}
