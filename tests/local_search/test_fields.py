"""What a problem can say is known to local search, or refused: a new field is never ignored."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from builders import act, after_passes, problem_of
from irc.local_search.ways import NotApplicable, ways_of
from irc.problem.activity import PLAIN


def test_a_field_of_a_resource_that_it_does_not_know_is_named() -> None:
    problem = after_passes(
        {
            "resources": [{"id": "oven", "capacity": 2}],
            "actions": [act(f"a{k}", uses=[{"resource": "oven"}]) for k in range(3)],
        }
    )
    (oven,) = problem.resources
    with pytest.raises(NotApplicable, match="'oven' has batch"):
        ways_of(replace(problem, resources=(replace(oven, batch=True),)))


@pytest.mark.parametrize(
    "field",
    [{"optional": True}, {"repeats": (1, 2)}, {"calendar": 0}, {"paused": True}, {"max_pause": 1}],
    ids=str,
)
def test_a_detail_that_it_does_not_know_is_named(field: dict[str, Any]) -> None:
    problem = problem_of(act("a"), act("b"))
    odd = replace(problem.activities[0], details=replace(PLAIN, **field))
    (name,) = field
    with pytest.raises(NotApplicable, match=f"'a' has {name.replace('_', ' ')}"):
        ways_of(replace(problem, activities=(odd, problem.activities[1])))
