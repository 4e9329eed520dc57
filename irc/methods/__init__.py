"""Methods: in, the text that a language model wrote; out, an `Answer`: its state, task and plan.

`METHODS` has the methods by name: how each asks a model, reads its answer and asks again.
`converse` runs one with a function that asks a model.

A reader takes what the model wrote and nothing else, so no gold value can reach an answer.
"""

from irc.frontends.importers.plan_lines import PlanLine, read_plan
from irc.frontends.importers.step_graph import Edge, StepGraph, WrittenAction
from irc.methods.answer import Answer, AnswerState
from irc.methods.instance import (
    GoldInstance,
    Instance,
    NotAnInstance,
    RunningInstance,
    kitchen_instance,
    running_instance,
    step_instance,
)
from irc.methods.loop import Conversation, ServiceFailure, converse
from irc.methods.method import METHODS, Method, method
from irc.methods.nl_ir import read_nl_ir
from irc.methods.pddl_answer import PddlAnswer, read_pddl_answer
from irc.methods.planner import read_plan_answer, read_planner
from irc.methods.prompt import Message
from irc.methods.reply import FinishReason, Reply, finished
from irc.methods.schedule_spec import read_schedule_spec

__all__ = [
    "METHODS",
    "Answer",
    "AnswerState",
    "Conversation",
    "Edge",
    "FinishReason",
    "GoldInstance",
    "Instance",
    "Message",
    "Method",
    "NotAnInstance",
    "PddlAnswer",
    "PlanLine",
    "Reply",
    "RunningInstance",
    "ServiceFailure",
    "StepGraph",
    "WrittenAction",
    "converse",
    "finished",
    "kitchen_instance",
    "method",
    "read_nl_ir",
    "read_pddl_answer",
    "read_plan",
    "read_plan_answer",
    "read_planner",
    "read_schedule_spec",
    "running_instance",
    "step_instance",
]
