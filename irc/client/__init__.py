"""The model client: in, messages and an endpoint; out, replies: counted, cached, recorded.

`ModelClient` asks; `answer_instances` lets it answer the instances of a benchmark with a method.
"""

from irc.client.completion import Completion, NoAnswer, Usage
from irc.client.kept import NotRecorded, StoreError
from irc.client.model_client import AskingEnded, Counts, ModelClient
from irc.client.options import ClientOptions
from irc.client.pipeline import Answered, PipelineError, ServiceGivenUp, answer_instances

__all__ = [
    "Answered",
    "AskingEnded",
    "ClientOptions",
    "Completion",
    "Counts",
    "ModelClient",
    "NoAnswer",
    "NotRecorded",
    "PipelineError",
    "ServiceGivenUp",
    "StoreError",
    "Usage",
    "answer_instances",
]
