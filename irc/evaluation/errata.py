"""Places where the paper prints another figure than its own recorded answers give."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from irc.evaluation.data import Data


@dataclass(frozen=True)
class Erratum:
    """A place of the paper or its data: what stands there, what is right, and why."""

    place: str
    printed: str
    right: str
    why: str

    def as_json(self) -> dict[str, str]:
        """The erratum as a JSON object."""
        return asdict(self)


_RECORDED = "counted in the recorded answers"

PAPER: Sequence[Erratum] = (
    Erratum(
        "size table, CP-SAT, gpt, N = 80", "0.45", "0.44", "the paper divides 22 by 49, not by 50"
    ),
    Erratum(
        "size table, CP-SAT, gpt, N = 90", "0.41", "0.40", "the paper divides 20 by 49, not by 50"
    ),
    Erratum("makespan table, PDDL, gpt, N = 5", "0.41", "0.70", _RECORDED),
    Erratum("makespan table, PDDL, gpt, N = 30", "0.36", "0.32", _RECORDED),
    Erratum("makespan table, PDDL, qwen, N = 5", "0.41", "0.54", _RECORDED),
    Erratum("makespan table, PDDL, gemini, average", "0.71", "0.62", _RECORDED),
    Erratum(
        "step-wise table, Planner, N = 80, missing dependencies",
        "78.5",
        "78.0",
        'one answer writes "4" for step4, and the paper compares names',
    ),
    Erratum(
        "figure 'error scaling'",
        "all models",
        "makespan accuracy of gemini and deepseek",
        "only two models are plotted",
    ),
    Erratum(
        "IR control table",
        "plan accuracy",
        "makespan accuracy",
        "all its rows but direct PDDL print the makespan under the title of the plan",
    ),
)

SUMMARY_ONLY: Sequence[str] = (
    "nl-ir at N = 100 of gemini, gpt and qwen",
    "online CP-SAT Formalizer of gemini, gpt and qwen (46.1 % in the paper)",
    "state-aware repair (84.5 % in the paper)",
    "Robotouille",
)
"""Runs whose raw answers are lost: their figures can only be quoted."""


def errata(data: Data) -> list[Erratum]:
    """Those of the paper, and the instances of the data whose gold contradicts their text."""
    return [*PAPER, *(_of_instance(item) for item in data.errata)]


def _of_instance(item: dict[str, object]) -> Erratum:
    return Erratum(
        f"AsyncPlan-XXL, N = {item['n']}, id {item['id']}, {item['field']}",
        str(item.get("recorded", "as in the data")),
        str(item.get("from_text", "as in the text")),
        str(item["why"]),
    )
