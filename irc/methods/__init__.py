"""Methods: in, the text that a language model wrote; out, an `Answer`: its state, task and plan.

A reader takes what the model wrote and nothing else, so no gold value can reach an answer.
"""

from irc.frontends.importers.plan_lines import PlanLine, read_plan
from irc.frontends.importers.step_graph import Edge, StepGraph, WrittenAction
from irc.methods.answer import Answer, AnswerState
from irc.methods.nl_ir import read_nl_ir
from irc.methods.pddl_answer import PddlAnswer, read_pddl_answer
from irc.methods.planner import read_plan_answer, read_planner
from irc.methods.schedule_spec import read_schedule_spec

__all__ = [
    "Answer",
    "AnswerState",
    "Edge",
    "PddlAnswer",
    "PlanLine",
    "StepGraph",
    "WrittenAction",
    "read_nl_ir",
    "read_pddl_answer",
    "read_plan",
    "read_plan_answer",
    "read_planner",
    "read_schedule_spec",
]
