"""Large random task graphs as JSON text, the same for the same arguments."""

from __future__ import annotations

import json
import random


def random_graph(actions: int, edges: int, seed: int = 1, reach: int = 50) -> str:
    """A task without resources: forward edges between steps at most `reach` apart."""
    rng = random.Random(seed)
    steps = [{"id": f"step{i}", "duration": 60 * rng.randint(1, 100)} for i in range(actions)]
    chosen: set[tuple[int, int]] = set()
    while len(chosen) < edges:
        a = rng.randrange(actions - 1)
        chosen.add((a, min(actions - 1, a + rng.randint(1, reach))))
    precedence = [{"before": f"step{a}", "after": f"step{b}"} for a, b in sorted(chosen)]
    return json.dumps({"actions": steps, "precedence": precedence})
