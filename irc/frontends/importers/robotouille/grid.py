"""The kitchen's floor: the robot's cell at each station, and the walking distances."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping

Cell = tuple[int, int]

_SIDES = ((0, 1), (0, -1), (1, 0), (-1, 0))

LARGEST_SIDE = 100
"""Kitchens with a longer side are refused."""


class Floor:
    """The cells of a grid without a station, on which the robot walks."""

    def __init__(self, width: int, height: int, stations: Iterable[Cell]) -> None:
        taken = set(stations)
        self._free = {(x, y) for x in range(width) for y in range(height) if (x, y) not in taken}

    def beside(self, cell: Cell) -> list[Cell]:
        """The free cells next to one, in a fixed order."""
        x, y = cell
        return sorted((x + dx, y + dy) for dx, dy in _SIDES if (x + dx, y + dy) in self._free)

    def walks(self, start: Cell) -> dict[Cell, int]:
        """The distance of each reachable cell in cells (breadth-first search)."""
        far = {start: 0}
        queue = deque([start])
        while queue:
            cell = queue.popleft()
            for next_cell in self.beside(cell):
                if next_cell not in far:
                    far[next_cell] = far[cell] + 1
                    queue.append(next_cell)
        return far


def standing_cells(
    floor: Floor, stations: Mapping[str, Cell], start: Cell, faced: str | None
) -> dict[str, Cell | None]:
    """The one cell from which each station is served; None if the robot cannot reach one.

    A station that the robot faces at the start is served from its first cell. For another station
    it is the reachable cell beside it with the least total distance to all other stations.
    """
    reachable = floor.walks(start)
    beside = {
        name: [c for c in floor.beside(cell) if c in reachable] for name, cell in stations.items()
    }
    if faced is not None:
        beside[faced] = [start]
    chosen: dict[str, Cell | None] = {}
    for name, cells in beside.items():
        others = [beside[other] for other in beside if other != name and beside[other]]
        chosen[name] = min(
            cells, key=lambda cell: (_total(floor, cell, others), cell), default=None
        )
    return chosen


def _total(floor: Floor, cell: Cell, others: Iterable[list[Cell]]) -> int:
    walks = floor.walks(cell)
    return sum(min(walks[other] for other in cells) for cells in others)


def walking_times(floor: Floor, places: Mapping[str, Cell]) -> dict[tuple[str, str], int]:
    """The steps from each place to each other one; turning without walking takes one step.

    A detour over a third place is never shorter.
    """
    walks = {name: floor.walks(cell) for name, cell in places.items()}
    return {
        (one, other): max(1, walks[one][places[other]])
        for one in places
        for other in places
        if one != other
    }
