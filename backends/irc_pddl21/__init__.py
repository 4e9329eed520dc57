"""The PDDL2.1 backend: a domain and a problem that any temporal planner can read.

`encoding` writes a problem as PDDL, `search` finds answers with `planners`, `engines` runs them,
`decoding` reads a plan as a schedule.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from irc.model.features import Feature
from irc.problem import Problem
from irc.targets import Backend, Engine

if TYPE_CHECKING:
    from irc.schedule import Schedule


class Pddl21(Backend):
    """Target "pddl21"."""

    name: ClassVar[str] = "pddl21"
    begins_now: ClassVar[bool] = True
    proves: ClassVar[bool] = False
    supports: ClassVar[frozenset[Feature]] = frozenset(
        {
            Feature.DURATION_RANGE,
            Feature.ZERO_DURATION,
            Feature.PRECEDENCE,
            Feature.PRECEDENCE_TYPES,
            Feature.MIN_LAG,
            Feature.NEGATIVE_LAG,
            Feature.MAX_LAG,
            Feature.RELEASE,
            Feature.DEADLINE,
            Feature.FIXED_START,
            Feature.LATEST_START,
            Feature.EARLIEST_END,
            Feature.RESOURCES,
            Feature.AMOUNTS,
            Feature.ALTERNATIVES,
            Feature.MODES,
            Feature.MODE_ELEMENTS,
            Feature.OPTIONAL_ACTIONS,
            Feature.REPEATED_ACTIONS,
            Feature.DUE_DATE,
            Feature.CALENDARS,
            Feature.ACTION_CALENDARS,
            Feature.PAUSES,
            Feature.SETUPS,
            Feature.RESERVOIRS,
            Feature.STATE,
            Feature.NUMBERS,
            Feature.TIMED_CHANGES,
            Feature.CONDITIONS,
            Feature.EFFECTS,
            Feature.STATE_GOALS,
            Feature.PRESENCE_GOALS,
            Feature.GROUPS,
            Feature.COUPLINGS,
            Feature.SELECTIONS,
            Feature.REWARD,
            Feature.COST,
            Feature.MAXIMIZE_REWARD,
            Feature.MINIMIZE_COST,
            Feature.SEVERAL_OBJECTIVES,
            Feature.MAKESPAN,
            Feature.TARDINESS,
            Feature.TARDY,
            Feature.MAX_TARDINESS,
            Feature.SETUP_TIME,
            Feature.SETUP_COST,
            Feature.OBJECTIVE_SUM,
        }
    )

    def encode(self, problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
        """`domain.pddl` and `problem.pddl`; `names` explain their names and numbers."""
        from irc_pddl21.encoding.encode import encode_files

        return encode_files(problem)

    def decode(self, problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
        """The schedule in a planner's text: its best complete plan, re-timed."""
        from irc_pddl21.decoding.decode import decode_plans

        return decode_plans(problem, names, answer)

    def engines(self) -> Mapping[str, Engine]:
        """The engines by name: OPTIC, kairos, aries, and the portfolio of the installed ones."""
        from irc_pddl21.engines import all_engines

        return all_engines()

    def greatest_horizon(self, problem: Problem) -> int:
        """The horizon up to which a planner can tell the times of a plan apart."""
        from irc_pddl21.planners.kairos import LARGEST

        # (Limits are written in finer units than ticks: at least in tenths.)
        return LARGEST // 10
