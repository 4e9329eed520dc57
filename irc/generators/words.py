"""Steps with durations as people would write them: a goal, and things to do for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from irc.generators.dice import Dice


@dataclass(frozen=True)
class Theme:
    """A goal ("open a small bakery"), and what is done for it: verbs and their objects."""

    goal: str
    verbs: tuple[str, ...]
    objects: tuple[str, ...]


THEMES = (
    Theme(
        "open a small bakery",
        ("Order", "Inspect", "Clean", "Label", "Arrange", "Photograph", "Price", "Pack"),
        (
            *("the flour sacks", "the bread tins", "the display shelves", "the rye loaves"),
            *("the cake stands", "the delivery crates", "the pastry trays", "the till"),
            *("the window signs", "the mixing bowls", "the cooling racks", "the menu cards"),
            "the paper bags",
        ),
    ),
    Theme(
        "prepare a garden for spring",
        ("Rake", "Water", "Measure", "Mark", "Cover", "Inspect", "Photograph", "Label"),
        (
            *("the herb bed", "the rose border", "the gravel path", "the vegetable patch"),
            *("the compost heap", "the lawn edge", "the greenhouse floor", "the berry bushes"),
            *("the seed trays", "the rain barrel", "the garden shed", "the apple trees"),
            "the stone terrace",
        ),
    ),
    Theme(
        "restore an old bicycle",
        ("Clean", "Inspect", "Sand", "Polish", "Measure", "Oil", "Photograph", "Wrap"),
        (
            *("the steel frame", "the front wheel", "the rear wheel", "the saddle"),
            *("the handlebar", "the chain", "the pedals", "the front brake"),
            *("the rear brake", "the fork", "the mudguards", "the lamp"),
            "the luggage rack",
        ),
    ),
    Theme(
        "hold a village music festival",
        ("Book", "Test", "Paint", "Insure", "Photograph", "Number", "Move", "List"),
        (
            *("the main stage", "the ticket booths", "the sound system", "the food stalls"),
            *("the first band", "the lighting rig", "the camp site", "the first aid tent"),
            *("the parking field", "the generator", "the fences", "the posters"),
            "the dressing rooms",
        ),
    ),
    Theme(
        "publish a cookbook",
        ("Draw", "Write", "Review", "Print", "Translate", "Check", "Scan", "Archive"),
        (
            *("the soup chapter", "the bread chapter", "the fish chapter", "the index"),
            *("the cover page", "the measure tables", "the salad chapter", "the preface"),
            *("the dessert chapter", "the photo pages", "the shopping lists", "the glossary"),
            "the author portrait",
        ),
    ),
    Theme(
        "set up a school laboratory",
        ("Unpack", "Test", "Label", "Calibrate", "Store", "List", "Clean", "Photograph"),
        (
            *("the microscopes", "the balances", "the glass beakers", "the gas taps"),
            *("the safety goggles", "the fume hood", "the thermometers", "the centrifuge"),
            *("the work benches", "the eye shower", "the sample fridge", "the pipettes"),
            "the fire blankets",
        ),
    ),
)

UNIT_TEXTS = (
    (604_800, "week"),
    (86_400, "day"),
    (3_600, "hour"),
    (60, "minute"),
    (1, "second"),
)

DURATIONS = (
    *(30, 60, 120, 180, 240, 300, 480, 600, 900, 1_200, 1_500, 1_800, 2_400, 2_700, 3_600),
    *(5_400, 7_200, 10_800, 14_400, 18_000, 21_600, 28_800, 43_200, 86_400, 172_800, 259_200),
    *(345_600, 604_800, 1_209_600),
)
"""Durations that people write, in seconds, the shortest first."""


def duration_text(seconds: int) -> str:
    """A duration in its largest unit that gives a whole number: "90 minutes", "2 days"."""
    for size, unit in UNIT_TEXTS:
        if seconds % size == 0:
            count = seconds // size
            return f"{count:,} {unit}{'' if count == 1 else 's'}".replace(",", "")
    raise ValueError(f"{seconds} s is no whole number of seconds")


def step_texts(theme: Theme, count: int, dice: Dice) -> list[str]:
    """Different things to do; beyond the number of pairs, for the second batch and so on."""
    pairs = [f"{verb} {thing}" for verb in theme.verbs for thing in theme.objects]
    found: list[str] = []
    batch = 1
    while len(found) < count:
        found += [p if batch == 1 else f"{p} of batch {batch}" for p in dice.shuffled(pairs)]
        batch += 1
    return found[:count]


def joined(items: Sequence[str]) -> str:
    """A list in words: "1", "1 and 2", "1, 2 and 3"."""
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"
