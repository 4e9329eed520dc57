# ruff: noqa: E501 - the tables hold texts as people write them
"""Whole texts: lists of steps with their durations in every form, headings, questions."""

from __future__ import annotations

import pytest

import irc
from english_texts import durations, first_error, order

CAKE = """\
Step 1. Preheat the oven (15 min)
Step 2. Prepare the batter (10 min)
Step 3. Bake (35 min)
"""

STEPS = [
    ("Step 1. Boil water (half an hour)", "1:Boil water=0.5 hour", ""),
    ("Step 1. Boil water (an hour and a half)", "1:Boil water=1.5 hour", ""),
    ("Step 1. Boil water (1 1/2 hours)", "1:Boil water=1.5 hours", ""),
    ("Step 1. Boil water (1 ½ hours)", "1:Boil water=1.5 hours", ""),
    ("Step 1. Boil water (1½ hours)", "1:Boil water=1.5 hours", ""),
    ("Step 1. Boil water (1.5 hours)", "1:Boil water=1.5 hours", ""),
    ("Step 1. Boil water (0.1 seconds)", "1:Boil water=0.1 seconds", ""),
    ("Step 1. Boil water (2-3 hours)", "1:Boil water=2 hours..3 hours", ""),
    ("Step 1. Boil water (2 to 3 hours)", "1:Boil water=2 hours..3 hours", ""),
    ("Step 1. Boil water (between 2 and 3 hours)", "1:Boil water=2 hours..3 hours", ""),
    ("Step 1. Boil water (30 minutes to 1 hour)", "1:Boil water=30 minutes..1 hour", ""),
    ("Step 1. Boil water (2 hours 30 minutes)", "1:Boil water=2 hours 30 minutes", ""),
    ("Step 1. Boil water (2 hours and 30 minutes)", "1:Boil water=2 hours 30 minutes", ""),
    ("Step 1. Boil water (2 hours, 30 minutes)", "1:Boil water=2 hours 30 minutes", ""),
    ("Step 1. Boil water (2h30min)", "1:Boil water=2 h 30 min", ""),
    ("Step 1. Boil water (2h 30m)", "1:Boil water=2 h 30 m", ""),
    ("Step 1. Boil water (1,000 seconds)", "1:Boil water=1000 seconds", ""),
    ("Step 1. Boil water (twenty minutes)", "1:Boil water=20 minutes", ""),
    ("Step 1. Boil water (twenty-five minutes)", "1:Boil water=25 minutes", ""),
    ("Step 1. Boil water (a quarter of an hour)", "1:Boil water=0.25 hour", ""),
    ("Step 1. Boil water (three quarters of an hour)", "1:Boil water=0.75 hour", ""),
    ("Step 1. Boil water (two and a half hours)", "1:Boil water=2.5 hours", ""),
    ("Step 1. Boil water (a month)", "1:Boil water=1 month", ""),
    ("Step 1. Boil water (5 mins.)", "1:Boil water=5 mins", ""),
    ("Step 1. Boil water. (5 min).", "1:Boil water=5 min", ""),
    ("Step 1: Boil water - 5 minutes", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water, 5 minutes", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water: 5 minutes", "1:Boil water=5 minutes", ""),
    ("Step 1 - Boil water - 5 minutes", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water takes 5 minutes", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water for 5 minutes", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water for half an hour.", "1:Boil water=0.5 hour", ""),
    ("Step 1: Boil water, which takes 5 minutes.", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water. It takes 5 minutes.", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water. This takes 5 minutes.", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water (takes 5 minutes)", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water (duration: 5 minutes)", "1:Boil water=5 minutes", ""),
    ("Step 1: Boil water [5 minutes]", "1:Boil water=5 minutes", ""),
    ("Step 1: (5 minutes) Boil water", "1:Boil water=5 minutes", ""),
    ("Step 1) Boil water (5 minutes)", "1:Boil water=5 minutes", ""),
    ("1) Boil water (5 minutes)", "1:Boil water=5 minutes", ""),
    ("1. Boil water (5 minutes)", "1:Boil water=5 minutes", ""),
    ("(1) Boil water (5 minutes)", "1:Boil water=5 minutes", ""),
    ("- Boil water (5 minutes)", "1:Boil water=5 minutes", ""),
    ("**Step 1:** Boil water (5 minutes)", "1:Boil water=5 minutes", ""),
    ("1. **Boil water** (5 minutes)", "1:Boil water=5 minutes", ""),
    ("1. Boil water - **5 minutes**", "1:Boil water=5 minutes", ""),
    ("Step 1. Boil water\n    Duration: 5 minutes", "1:Boil water=5 minutes", ""),
    ("Step 1. Boil water\n    (5 minutes)", "1:Boil water=5 minutes", ""),
    (
        "Step 1. Boil the water in a large\n   pot with salt (5 minutes)",
        "1:Boil the water in a large pot =5 minutes",
        "",
    ),
    ("Step 1. Simmer for 10 minutes (15 minutes)", "1:Simmer for 10 minutes=15 minutes", ""),
    (
        "Step 1. Fast for eight hours prior to the procedure (8 hours)",
        "1:Fast for eight hours prior to =8 hours",
        "",
    ),
    (
        "Step 1. Preheat your oven to 375 °F (191 °C) and prepare a dish. (10 min)",
        "1:Preheat your oven to 375 °F (1=10 min",
        "",
    ),
    ("Step 1. Boil water (a fortnight)", "1:Boil water=2 weeks", ""),
    ("Step 1. Boil water (0 minutes)", "1:Boil water=0 minutes", ""),
    ("Step 1. Boil (5 min)\nStep 1. Boil (5 min)", "1:Boil=5 min; 1:Boil=5 min", ""),
    (
        "1. Boil water (5 min)\n2. Cut onions (3 min, after step 1)",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min)\n2. Cut onions (3 min) (requires step 1)",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min)\n2. Cut onions after step 1 (3 min)",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min)\n2. Cut onions (3 min), after 1",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min)\n   Depends on: none\n2. Cut onions (3 min)\n   Depends on: step 1",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min)\n   - Prerequisites: none\n2. Cut onions\n   - Duration: 3 min\n   - Prerequisites: 1",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min). 2. Cut onions (3 min). Step 1 must precede step 2.",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "Step 1. Boil water (5 min). Step 2. Cut onions (3 min). Step 1 must precede step 2.",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "A. Boil water (5 min)\nB. Cut onions (3 min)\nA must precede B.",
        "A:Boil water=5 min; B:Cut onions=3 min",
        "A>B",
    ),
    (
        "Task A: Boil water (5 min)\nTask B: Cut onions (3 min)\nTask B depends on task A.",
        "A:Boil water=5 min; B:Cut onions=3 min",
        "A>B",
    ),
    (
        "T1: Boil water (5 min)\nT2: Cut onions (3 min)\nT1 must precede T2.",
        "T1:Boil water=5 min; T2:Cut onions=3 min",
        "T1>T2",
    ),
    (
        "- Boil water (5 min)\n- Cut onions (3 min)\nBoil water before cutting onions.",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        '- Boil water (5 min)\n- Cut onions (3 min)\n"Boil water" must be finished before "Cut onions" starts.',
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "# Soup\n1. Boil water (5 min)\n2. Cut onions (3 min)\n## Constraints\n- 1 before 2",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "Soup\n1. Boil water (5 min)\n2. Cut onions (3 min)\n1 before 2",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "I want to make soup.\nSteps:\n1. Boil water (5 min)\n2. Cut onions (3 min)\nConstraints:\n1. Step 1 must precede step 2.\nHow long does it take to make soup?",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "To make soup, you need to do the following:\n1. Boil water (5 min)\n2. Cut onions (3 min)\nStep 2 requires step 1. What is the minimum time needed?",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min)\n2. Cut onions (3 min)\n1 before 2. What is the shortest time to make soup?",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min)\n2. Cut onions (3 min)\n1 before 2. Calculate the shortest time to complete all steps.",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "1>2",
    ),
    (
        "1. Boil water (5 min)\n2. Cut onions (3 min)\nThe steps can be done in any order. Give your answer in minutes.",
        "1:Boil water=5 min; 2:Cut onions=3 min",
        "",
    ),
    (
        "1. Boil water\n2. Cut onions\nStep 1 takes 5 minutes and step 2 takes 3 minutes. 1 before 2.",
        "1:Boil water=5 minutes; 2:Cut onions=3 minutes",
        "1>2",
    ),
    (
        "1. Boil water\n2. Cut onions\nSteps 1 and 2 take 5 minutes each. 1 before 2.",
        "1:Boil water=5 minutes; 2:Cut onions=5 minutes",
        "1>2",
    ),
    (
        "1. Boil water\n2. Cut onions\nEach step takes 5 minutes. 1 before 2.",
        "1:Boil water=5 minutes; 2:Cut onions=5 minutes",
        "1>2",
    ),
    (
        "1. Boil water\n2. Cut onions\nBoiling water takes 5 minutes. Cutting onions takes 3 minutes. 1 before 2.",
        "1:Boil water=5 minutes; 2:Cut onions=3 minutes",
        "1>2",
    ),
    (
        "1. Boil water\n2. Cut onions\nDurations:\nStep 1: 5 minutes\nStep 2: 3 minutes\n1 before 2.",
        "1:Boil water=5 minutes; 2:Cut onions=3 minutes",
        "1>2",
    ),
    (
        "Step 1: 5 minutes\nStep 2: 3 minutes\nStep 1 must precede step 2.",
        "1:=5 minutes; 2:=3 minutes",
        "1>2",
    ),
    (
        "Task A (3 days): design\nTask B (2 days): build\nTask C (1 day): test\nB needs A. C needs B.",
        "A:design=3 days; B:build=2 days; C:test=1 day",
        "A>B B>C",
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must come before steps 2 and 3 but step 3 before step 2.",
        "1:Wash=30 min; 2:Wax=1 hour; 3:Dry=20 min",
        "1>2 1>3 3>2",
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 2 must start before step 1 is finished.",
        "1:Wash=30 min; 2:Wax=1 hour; 3:Dry=20 min",
        "2s>e1",
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. What is the total time?",
        "1:Wash=30 min; 2:Wax=1 hour; 3:Dry=20 min",
        "1>2",
    ),
]

REFUSED_STEPS = [
    ("Step 1. Boil water (about 5 minutes)", "IRC022", 1, 21),
    ("Step 1. Boil water (~5 minutes)", "IRC022", 1, 21),
    ("Step 1. Boil water (a few minutes)", "IRC022", 1, 21),
    ("Step 1. Boil water (a couple of minutes)", "IRC022", 1, 21),
    ("Step 1. Boil water (5 minutes or so)", "IRC022", 1, 31),
    ("Step 1. Boil water (up to 5 minutes)", "IRC022", 1, 21),
    ("Step 1. Boil water (at least 5 minutes)", "IRC022", 1, 21),
    ("Step 1. Boil water (5+ minutes)", "IRC025", 1, 1),
    ("Step 1. Boil water (less than 5 minutes)", "IRC022", 1, 21),
    ("Step 1. Boil water (5 minutes each)", "IRC020", 1, 21),
    ("Step 1. Boil water (5 minuets)", "IRC025", 1, 1),
    ("Step 1. Boil water (5)", "IRC025", 1, 1),
    ("Step 1. Boil water", "IRC025", 1, 1),
    ("Step 1. Boil water (overnight)", "IRC025", 1, 1),
    ("Step 1. Boil water (1:30)", "IRC025", 1, 1),
    ("Step 1. Boil water (1,5 hours)", "IRC020", 1, 21),
    ("Step 1. Boil water (5 minutes 2 hours)", "IRC021", 1, 21),
    ("Step 1. Boil water (3-2 hours)", "IRC021", 1, 21),
    ("Step 1. Boil water (-5 minutes)", "IRC020", 1, 21),
    ("Step 1. Boil water (5 minutes) and stir (3 minutes)", "IRC021", 1, 9),
    ("Step 1. Boil water (5 minutes) (3 minutes)", "IRC027", 1, 21),
    ("Step 1. Bake for 20 minutes, then cool for 10 minutes", "IRC021", 1, 9),
    ("Step 1. Rub the kumquat (optional). (5 min)", "IRC022", 1, 1),
    ("Step 1. Boil water (5 business days)", "IRC025", 1, 1),
    ("Step 1. Boil water (1e3 seconds)", "IRC020", 1, 21),
    ("Step 1. Boil water (5 minutes\nStep 2. x (3 minutes)", "IRC025", 1, 1),
    ("Step 1. Boil (5 min)\nStep 1. Fry (5 min)", "IRC202", 2, 1),
    ("Step 1. Boil (5 min)\nStep 2. Fry (5 min)", "IRC026", 1, 1),
    ("1. Boil water (5 min)\n2. Then cut onions (3 min)", "IRC021", 2, 4),
    ("Boil water: 5 min\nCut onions: 3 min\nBoil water before cutting onions.", "IRC002", 1, 1),
    (
        "Making soup requires the following steps:\n1. Boil water (5 min)\n2. Cut onions (3 min)\n1 before 2. How long will it take at minimum to make soup if I work alone?",
        "IRC023",
        4,
        59,
    ),
    (
        "1. Boil water (5 min)\n2. Cut onions (3 min)\n1 before 2. What is the shortest time to make soup if only one pot is available?",
        "IRC023",
        3,
        52,
    ),
    ("1. Boil water\n2. Cut onions\nSteps 1 and 2 take 5 minutes. 1 before 2.", "IRC025", 1, 1),
    (
        "1. Mix (5 min)\n2. Bake (must start right after mixing) (35 min)\n1 before 2.",
        "IRC021",
        2,
        27,
    ),
    (
        "1. Mix the dough (5 min)\n2. Bake after mixing the dough (35 min)\n1 before 2.",
        "IRC021",
        2,
        9,
    ),
    (
        "# Soup\n1. Boil water (5 min)\n2. Cut onions (3 min)\n## The stove fits one pot\n- 1 before 2",
        "IRC028",
        4,
        1,
    ),
    (
        "1. Boil water (5 min)\n2. Cut onions (3 min)\n1 before 2. What is the shortest time to make soup with a friend?",
        "IRC028",
        3,
        13,
    ),
    (
        "Step 1. Wash the car (30 min)\nStep 2. Wax the car (1 hour)\nStep 3. Vacuum the seats (20 min)\nStep 2 must not begin until step 1 ends. Step 3 whenever.",
        "IRC020",
        4,
        42,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2, not step 3.",
        "IRC023",
        4,
        29,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nSteps 2 and 3 cannot start until step 1 and not before noon.",
        "IRC023",
        4,
        45,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 2 can be done after step 1 or in parallel with it.",
        "IRC023",
        4,
        33,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 2 can start once step 1 is halfway done.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 2 can start once step 1 is half done.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 3 must be done while step 2 is running.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nSteps 1 and 2 must be done together. Step 3 last.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2 twice.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 3 must be repeated after step 2. 1 before 2.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 before step 2 before step 3.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2 which must precede step 3.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nOrder: 1, 2, 3.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\n1 < 2 < 3",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. We must finish by 5 pm.",
        "IRC020",
        4,
        29,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. Step 3 takes twice as long as step 1.",
        "IRC020",
        4,
        29,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. I want to finish within an hour.",
        "IRC020",
        4,
        29,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. Assume you need to execute all the steps except step 3.",
        "IRC023",
        4,
        70,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. What is the shortest possible time to complete steps 1 and 2?",
        "IRC020",
        4,
        29,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. What is the longest possible time?",
        "IRC020",
        4,
        29,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. What is the total time if everything is done sequentially?",
        "IRC023",
        4,
        52,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. Assume that you need to execute all the steps to complete the task and that limited resources are available.",
        "IRC028",
        4,
        29,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nStep 1 must precede step 2. Assume there are infinite resources but only one car.",
        "IRC028",
        4,
        29,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nThe following constraints do not apply:\nStep 1 must precede step 2.",
        "IRC023",
        4,
        30,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nIgnore the following constraints:\nStep 1 must precede step 2.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nFor example:\nStep 1 must precede step 2.",
        "IRC020",
        4,
        1,
    ),
    (
        "Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\nIt is false that step 1 must precede step 2.",
        "IRC020",
        4,
        1,
    ),
    (
        'Step 1. Wash (30 min)\nStep 2. Wax (1 hour)\nStep 3. Dry (20 min)\n"Step 1 must precede step 2." is not true. 2 before 3.',
        "IRC023",
        4,
        34,
    ),
    ("Step 1. Wash (30 min for each of 2 cars)\nStep 2. Wax (1 hour)\n1 before 2", "IRC020", 1, 15),
    ("Step 1. Wash (30 min per car)\nStep 2. Wax (1 hour)\n1 before 2", "IRC020", 1, 15),
    ("Step 1. Wash (30 min, twice)\nStep 2. Wax (1 hour)\n1 before 2", "IRC020", 1, 15),
    ("Step 1. Wash (30 min + 10 min)\nStep 2. Wax (1 hour)\n1 before 2", "IRC020", 1, 15),
    ("Step 1. Wash - twice - 30 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC021", 1, 9),
    ("Step 1. Wash (30 min if dirty)\nStep 2. Wax (1 hour)\n1 before 2", "IRC023", 1, 22),
    ("Step 1. Wash: 2 x 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wash, twice, 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC021", 1, 9),
    ("Step 1. Wash, no more than 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wash for about 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wash for at least 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wash takes up to 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wash takes 15 min or 20 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    (
        "Step 1. Wash takes 15 min more than step 2\nStep 2. Wax (1 hour)\n1 before 2",
        "IRC025",
        1,
        1,
    ),
    ("Step 1. Wash every 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wash after 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wait until it has been 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wash, at 15 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC025", 1, 1),
    ("Step 1. Wash 5, 10 min\nStep 2. Wax (1 hour)\n1 before 2", "IRC021", 1, 9),
    (
        "Step 1. Wash. Do not take longer than 15 min.\nStep 2. Wax (1 hour)\n1 before 2",
        "IRC025",
        1,
        1,
    ),
    ("Step 1. Read chapter 1 - 2 hours\nStep 2. Wax (1 hour)\n1 before 2", "IRC021", 1, 9),
    ("Step 1. Read pages 10 - 20 minutes\nStep 2. Wax (1 hour)\n1 before 2", "IRC021", 1, 9),
    ("Step 1. Fix the last 5 - 10 minutes\nStep 2. Wax (1 hour)\n1 before 2", "IRC021", 1, 9),
]

# Written by others, without a look at the grammar.

OTHER_AUTHORS = [
    (
        "Steps:\n1. Mix dough: 10 min\n2. Let rise: 1 h\n3. Shape: 5 min\n4. Bake: 30 min\nOrder: 1 -> 2 -> 3 -> 4",
        "1:Mix dough=10 min; 2:Let rise=1 h; 3:Shape=5 min; 4:Bake=30 min",
        "1>2 2>3 3>4",
    ),
    (
        "Task A (3 days): design\nTask B (2 days): build\nTask C (1 day): test\nB needs A. C needs B.",
        "A:design=3 days; B:build=2 days; C:test=1 day",
        "A>B B>C",
    ),
    (
        CAKE + "You need to have finished steps 1 and 2 before you begin step 3.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Step 3 can't happen before steps 1 and 2.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Do steps 1 and 2 in parallel, then step 3.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Step 3 is blocked by steps 1 and 2.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Step 1 blocks step 3. Step 2 blocks step 3.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Constraints: step 1 before step 3, step 2 before step 3.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Dependencies:\n3 depends on 1, 2",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE
        + "Step 3 happens last. Step 1 and step 2 can overlap. How quickly can the cake be ready?",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Step 3 must begin no sooner than 5 minutes after step 2.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "2>3+5 minutes",
    ),
    (
        CAKE + "Step 3 must begin within 5 minutes of the end of step 2.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "2>3..5 minutes",
    ),
    (
        CAKE + "Steps 1 and 2 first, then step 3.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Steps 1 & 2 must be completed prior to step 3.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
    (
        CAKE + "Follow the steps in order.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>2 2>3",
    ),
    (
        CAKE + "Step 3 requires step 2, and step 2 requires step 1.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "2>3 1>2",
    ),
    (
        CAKE + "Finish step 2 before step 3, but step 1 can be done whenever.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "2>3",
    ),
    (
        CAKE + "It is essential that step 1 is done before step 3.",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3",
    ),
    (
        CAKE + "Step 1 and 2 are prerequisites for step 3. Minimum total time?",
        "1:Preheat the oven=15 min; 2:Prepare the batter=10 min; 3:Bake=35 min",
        "1>3 2>3",
    ),
]

REFUSED_OTHER_AUTHORS = [
    (
        "Getting ready for a camping trip\n\n1. Pack the tent – 20 minutes\n2. Buy groceries – 45 minutes\n3. Load the car – 15 minutes\n4. Drive to the site – 2 hours\n\nYou can't load the car until the tent is packed and the groceries are bought. The drive comes last.",
        "IRC023",
        8,
        5,
    ),
    (
        "To host a dinner, here's what needs to be done:\n- Clean the house (1 hour)\n- Cook dinner (90 min)\n- Set the table (10 min)\nSet the table after cleaning the house. Cook dinner can happen any time.",
        "IRC020",
        5,
        41,
    ),
    (
        "Step 1: Sand the table (40 minutes).\nStep 2: Paint the table (1 hour).\nStep 3: Let the paint dry (6 hours).\nPainting follows sanding. Step 3 comes right after step 2.",
        "IRC020",
        4,
        1,
    ),
    (
        "There are four tasks. Task 1 takes 3 hours, task 2 takes 2 hours, task 3 takes 1 hour and task 4 takes 30 minutes. Task 1 must be done before task 3. Tasks 2 and 3 must both be done before task 4. How long does it take?",
        "IRC029",
        1,
        1,
    ),
    (CAKE + "Before you bake, preheat the oven and prepare the batter.", "IRC028", 4, 1),
    (
        CAKE
        + "Steps 1 and 2 can happen simultaneously, but both have to be complete before step 3.",
        "IRC023",
        4,
        42,
    ),
    (CAKE + "There's just one of me, so no multitasking. Step 1 before 3.", "IRC023", 4, 9),
    (CAKE + "Step 3 should only be attempted once 1 and 2 are out of the way.", "IRC023", 4, 15),
    (CAKE + "Step 1 isn't needed for step 2. Step 3 depends on both.", "IRC023", 4, 8),
    (
        CAKE + "Step 2 doesn't need to wait for step 1. Step 3 needs both step 1 and step 2.",
        "IRC023",
        4,
        8,
    ),
    (CAKE + "Dependencies:\n1: none\n2: none\n3: 1, 2", "IRC020", 5, 1),
    (CAKE + "Everything except step 3 can be done at once.", "IRC023", 4, 12),
    (
        CAKE
        + "After steps 1 and 2 have both been finished, step 3 may be started. Assume unlimited helpers. What's the fastest we can finish?",
        "IRC020",
        4,
        95,
    ),
    (CAKE + "The oven must be preheated before baking.", "IRC028", 4, 1),
    (CAKE + "Let the batter rest for 10 minutes between step 2 and step 3.", "IRC020", 4, 1),
    (CAKE + "Step 1 must precede step 3 and so must step 2.", "IRC020", 4, 1),
    (
        CAKE
        + "Step 1 must be completed before 3. Step 2 must also be completed before 3. Nothing else is constrained.",
        "IRC020",
        4,
        76,
    ),
    (
        CAKE + "The steps may be performed in any order except that step 3 comes last.",
        "IRC023",
        4,
        41,
    ),
    (CAKE + "Complete steps 1-2 before step 3. Assume you have two ovens.", "IRC028", 4, 35),
    (CAKE + "Step 3 has to come after 1 and 2. I have an hour. Can I make it?", "IRC020", 4, 35),
    (CAKE + "Step 3 requires step 2, which requires step 1.", "IRC020", 4, 1),
]


@pytest.mark.parametrize(("text", "times", "orders"), [*STEPS, *OTHER_AUTHORS])
def test_a_text_is_read_as_it_says(text: str, times: str, orders: str) -> None:
    task = irc.loads(text).ir
    assert (durations(task), order(task)) == (times, orders)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "code", "line", "column"), [*REFUSED_STEPS, *REFUSED_OTHER_AUTHORS]
)
def test_an_inexact_text_is_refused_at_its_place(
    text: str, code: str, line: int, column: int
) -> None:
    assert first_error(text) == (code, line, column)
