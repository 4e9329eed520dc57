"""The CP-SAT backend: interval variables for ortools, or for any other CP-SAT.

`encoding` writes a problem as a model, `solving` finds answers, `engines` runs ortools, `decode`
reads an answer as a schedule.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from irc.model.features import Feature
from irc.problem import Problem
from irc.targets import Backend, Engine

if TYPE_CHECKING:
    from irc.schedule import Schedule
    from irc.targets.refuter import Refuter


class CpSat(Backend):
    """Target "cpsat"."""

    name: ClassVar[str] = "cpsat"
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
            Feature.PRESENCE_GOALS,
            Feature.STATE_GOALS,
            Feature.MODES,
            Feature.MODE_ELEMENTS,
            Feature.OPTIONAL_ACTIONS,
            Feature.REPEATED_ACTIONS,
            Feature.DUE_DATE,
            Feature.CALENDARS,
            Feature.SETUPS,
            Feature.ACTION_CALENDARS,
            Feature.PAUSES,
            Feature.NO_IDLE,
            Feature.BATCHES,
            Feature.RESERVOIRS,
            Feature.STATE,
            Feature.NUMBERS,
            Feature.TIMED_CHANGES,
            Feature.TIMED_LEVELS,
            Feature.CONDITIONS,
            Feature.EFFECTS,
            Feature.GROUPS,
            Feature.COUPLINGS,
            Feature.SELECTIONS,
            Feature.SEQUENCES,
            Feature.REWARD,
            Feature.COST,
            Feature.MAKESPAN,
            Feature.TARDINESS,
            Feature.TARDY,
            Feature.MAX_TARDINESS,
            Feature.EARLINESS,
            Feature.FLOW_TIME,
            Feature.OBJECTIVE_SUM,
            Feature.MAXIMIZE_REWARD,
            Feature.MINIMIZE_COST,
            Feature.MINIMIZE_CHANGES,
            Feature.SETUP_TIME,
            Feature.SETUP_COST,
            Feature.SEVERAL_OBJECTIVES,
        }
    )

    def encode(self, problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
        """`model.pbtxt`, a `CpModelProto` in text form; `names` explain its variables."""
        from irc_cpsat.encoding.encode import encode_files

        return encode_files(problem)

    def decode(self, problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
        """The schedule in a `CpSolverResponse` in text form."""
        from irc_cpsat.decode import decode_response

        return decode_response(problem, names, answer)

    def engines(self) -> Mapping[str, Engine]:
        """The engines by name: ortools, in this process."""
        from irc_cpsat.engines import OrTools

        engine = OrTools()
        return {"auto": engine, engine.name: engine}

    def greatest_horizon(self, problem: Problem) -> int:
        """The horizon at which sums would no longer fit 64 bits."""
        from irc_cpsat.encoding.overflow import greatest_horizon

        return greatest_horizon(problem)

    def refuter(self) -> Refuter:
        """CP-SAT as the judge of which statements cannot hold together."""
        from irc_cpsat.loading import load_cp_model

        load_cp_model()
        from irc_cpsat.solving.refuter import CpSatRefuter

        return CpSatRefuter()
