"""Sentences of order: each is read exactly as it says, or refused at its place."""

from __future__ import annotations

import pytest

import irc
from english_texts import first_error, order

FIVE_STEPS = """\
Step 1. Boil the water (10 minutes)
Step 2. Chop the onions (5 minutes)
Step 3. Fry the onions (7 minutes)
Step 4. Cook the pasta (12 minutes)
Step 5. Serve (1 minute)

These ordering constraints need to be obeyed:
"""

READ = [
    ("Step 1 must precede step 4.", "1>4"),
    ("Step 1 must precede Steps 3, 4, and 5.", "1>3 1>4 1>5"),
    ("Step 2 must precede step 3, 4 and 5.", "2>3 2>4 2>5"),
    ("Steps 1 and 3 must precede step 4", "1>4 3>4"),
    ("step 1 precedes step 4", "1>4"),
    ("Step 4 must follow step 1.", "1>4"),
    ("Step 4 follows steps 1 and 2.", "1>4 2>4"),
    ("Step 1 has to be done before step 4.", "1>4"),
    ("Step 1 must be completed before step 4 can begin.", "1>4"),
    ("Step 1 needs to be finished before starting step 4.", "1>4"),
    ("Step 1 should be finished before step 4 starts.", "1>4"),
    ("Do step 1 before step 4.", "1>4"),
    ("Finish step 1 before you start step 4.", "1>4"),
    ("You must complete steps 1 and 2 before starting step 4.", "1>4 2>4"),
    ("Before step 4, do step 1.", "1>4"),
    ("Before starting step 4, you must finish step 1.", "1>4"),
    ("Before you can start step 4, step 1 must be complete.", "1>4"),
    ("Step 4 must be done after step 1.", "1>4"),
    ("Step 4 comes after step 1.", "1>4"),
    ("Step 4 can only start after step 1 is finished.", "1>4"),
    ("Step 4 can start once steps 1 and 3 are done.", "1>4 3>4"),
    ("Step 4 cannot start until step 1 has finished.", "1>4"),
    ("Step 4 can't begin before step 1 is completed.", "1>4"),
    ("Step 4 must not be started until steps 1, 2 and 3 have been completed.", "1>4 2>4 3>4"),
    ("Step 4 may only begin when step 1 is complete.", "1>4"),
    ("Once step 1 is done, step 4 can start.", "1>4"),
    ("Once step 1 is finished, start steps 3 and 4.", "1>3 1>4"),
    ("After step 1, do step 4.", "1>4"),
    ("After finishing step 1, you can begin step 4.", "1>4"),
    ("As soon as step 1 is over, step 4 can begin.", "1>4"),
    ("Only after step 1 is finished can step 4 begin.", "1>4"),
    ("Step 4 depends on step 1.", "1>4"),
    ("Step 4 depends on steps 1 and 3.", "1>4 3>4"),
    ("Step 4 requires step 1.", "1>4"),
    ("Step 4 requires step 1 to be completed first.", "1>4"),
    ("Step 4 requires the completion of step 1.", "1>4"),
    ("Step 4 needs steps 1 and 2 to be finished.", "1>4 2>4"),
    ("Step 1 is a prerequisite for step 4.", "1>4"),
    ("Step 1 is a prerequisite of steps 4 and 5.", "1>4 1>5"),
    ("Step 1 is required before step 4.", "1>4"),
    ("Step 4 must wait for step 1.", "1>4"),
    ("Step 4 has to wait until step 1 is finished.", "1>4"),
    ("Step 4 must wait for step 1 to finish.", "1>4"),
    ("Step 1 must be followed by step 4.", "1>4"),
    ("Step 4 must be preceded by step 1.", "1>4"),
    ("First do step 1, then step 3, then step 4.", "1>3 3>4"),
    ("Step 1, then step 2, then step 3.", "1>2 2>3"),
    ("Step 1 -> step 3 -> step 5", "1>3 3>5"),
    ("1 -> 4", "1>4"),
    ("Step 1 → Step 2 → Step 3 → Step 4 → Step 5", "1>2 2>3 3>4 4>5"),
    ("Start with step 1, followed by step 2 and then step 3.", "1>2 2>3"),
    ("Step 1 must be done first.", "1>2 1>3 1>4 1>5"),
    ("Step 5 must come last.", "1>5 2>5 3>5 4>5"),
    ("Step 5 is the last step.", "1>5 2>5 3>5 4>5"),
    ("Steps 1, 2 and 3 must be done in order.", "1>2 2>3"),
    ("All steps must be done in order.", "1>2 2>3 3>4 4>5"),
    ("The steps must be done in the order listed.", "1>2 2>3 3>4 4>5"),
    ("Each step can only start after the previous one is finished.", "1>2 2>3 3>4 4>5"),
    ("Steps 1 to 4 must precede step 5.", "1>5 2>5 3>5 4>5"),
    ("Steps 1-4 must be finished before step 5.", "1>5 2>5 3>5 4>5"),
    ("Steps 1 through 3 must precede step 4.", "1>4 2>4 3>4"),
    ("All other steps must precede step 5.", "1>5 2>5 3>5 4>5"),
    ("Step 5 requires all other steps to be finished.", "1>5 2>5 3>5 4>5"),
    ("Step 5 requires all previous steps.", "1>5 2>5 3>5 4>5"),
    ("Nothing can start until step 1 is finished.", "1>2 1>3 1>4 1>5"),
    ("No other step can start until step 1 is done.", "1>2 1>3 1>4 1>5"),
    ("Steps 2 and 3 can be done in parallel.", ""),
    ("Step 2 and step 3 can be done at the same time.", ""),
    ("Step 2 can be done in parallel with step 3.", ""),
    ("Steps 2 and 3 are independent of each other.", ""),
    ("Steps 2 and 3 can be done in any order.", ""),
    ("Step 1 must precede step 2 and step 3 must precede step 4.", "1>2 3>4"),
    ("Step 1 must precede step 2, and step 3 must precede step 4.", "1>2 3>4"),
    ("Step 1 must precede step 2; step 2 must precede step 3.", "1>2 2>3"),
    ("Step 3 must be done after step 2 but before step 5.", "2>3 3>5"),
    ("Step 3 must come between step 1 and step 5.", "1>3 3>5"),
    ("Both step 1 and step 2 must be done before step 4.", "1>4 2>4"),
    ("Step 1 and step 2 must both be finished before step 4 starts.", "1>4 2>4"),
    ("Each of steps 1, 2 and 3 must precede step 5.", "1>5 2>5 3>5"),
    ("All of steps 1 to 4 must be finished before step 5 can start.", "1>5 2>5 3>5 4>5"),
    ("Steps 1, 2, and 3 must all be completed before step 4 begins.", "1>4 2>4 3>4"),
    ("Neither step 3 nor step 4 can start until step 1 is finished.", "1>3 1>4"),
    ("Do not start step 4 until step 1 is done.", "1>4"),
    ("Don't do step 4 before step 1.", "1>4"),
    ("Wait until step 1 is finished before starting step 4.", "1>4"),
    ("Wait for step 1 to finish before you start step 4.", "1>4"),
    ("Step 4 must start at least 10 minutes after step 1 is finished.", "1>4+10 minutes"),
    ("Step 4 must start at most 1 hour after step 1 ends.", "1>4..1 hour"),
    ("Step 4 must start no more than 1 hour after step 1.", "1>4..1 hour"),
    ("Step 4 must start exactly 5 minutes after step 1 ends.", "1>4+5 minutes..5 minutes"),
    ("Step 4 must start within 30 minutes of step 1 finishing.", "1>4..30 minutes"),
    ("Step 4 must start within 30 minutes after step 1.", "1>4..30 minutes"),
    ("Step 4 must start immediately after step 1.", "1>4..0 s"),
    ("Step 4 must immediately follow step 1.", "1>4..0 s"),
    ("There must be at least 10 minutes between step 1 and step 4.", "1>4+10 minutes"),
    ("Wait at least 10 minutes after step 1 before starting step 4.", "1>4+10 minutes"),
    ("Step 2 and step 3 must start at the same time.", "2s>s3..0 s"),
    ("Step 4 cannot start until at least 10 minutes after step 1 is finished.", "1>4+10 minutes"),
    ("Step 4 must start after step 1 starts.", "1s>s4"),
    ("Step 4 must start before step 5 starts.", "4s>s5"),
    ("Step 3 cannot finish before step 4 finishes.", "4e>e3"),
    ("Steps 2 and 3 cannot be done at the same time.", " | one at a time 1:1=2,3"),
    ("Only one step can be done at a time.", " | steps at a time:1=1,2,3,4,5"),
    ("At most two steps can be done at the same time.", " | steps at a time:2=1,2,3,4,5"),
    ("No two of steps 2, 3 and 4 can be done at the same time.", " | one at a time 1:1=2,3,4"),
    ("Everything must be finished within 1 hour.", " | deadline 1 hour"),
    ("Boiling the water must precede cooking the pasta.", "1>4"),
    ('"Boil the water" must be done before "Cook the pasta".', "1>4"),
    ("Boil the water before cooking the pasta.", "1>4"),
    ("Cook the pasta after boiling the water.", "1>4"),
    ("Chop the onions must precede fry the onions.", "2>3"),
    ("The first step must precede the last step.", "1>5"),
    ("The second step must be done before the third step.", "2>3"),
    ("Also, step 1 must precede step 4.", "1>4"),
    ("Note that step 1 must precede step 4.", "1>4"),
    ("Please make sure that step 1 is finished before step 4 starts.", "1>4"),
    ("Step 1 has no prerequisites.", ""),
    ("Step 2 does not depend on any other step.", ""),
    ("Step 2 can start immediately.", ""),
    ("There are no other constraints.", ""),
    ("Task 1 must precede task 4.", "1>4"),
    ("Step 1 takes 10 minutes.", ""),
    ("First, do step 1. Then do steps 2, 3 and 4. Finally, do step 5.", "1>2 1>3 1>4 2>5 3>5 4>5"),
    ("After boiling the water, cook the pasta.", "1>4"),
    ("Step 1 must precede step 1.", "1>1"),
    ("Step 1 must precede step 2. Step 2 must precede step 1.", "1>2 2>1"),
    ("Step one must precede step four.", "1>4"),
    ("Steps two and three must precede step five.", "2>5 3>5"),
    ("step 1 MUST PRECEDE step 4", "1>4"),
    ("Step1 must precede step4.", "1>4"),
    ("#1 must precede #4.", "1>4"),
    ("Step 1 must precede step 4!", "1>4"),
    ("Step 1 must\nprecede step 4.", "1>4"),
    ("Step 1 must precede step 2\nand step 3.", "1>2 1>3"),
    ("Step 1 must precede Step 4", "1>4"),
    ("- Step 1 must precede step 4\n- Step 2 must precede step 3", "1>4 2>3"),
    ("1. Step 1 must precede step 4\n2. Step 2 must precede step 3", "1>4 2>3"),
    ("* 1 before 4\n* 2 before 3", "1>4 2>3"),
    ("Step 1 before step 4", "1>4"),
    ("1 before 4", "1>4"),
    ("Steps 2 and 3 come after step 1 and before step 5.", "1>2 1>3 2>5 3>5"),
    ("Step 3 requires steps 1 and 2 to have been completed.", "1>3 2>3"),
    ("Step 4 must occur after both step 1 and step 3.", "1>4 3>4"),
    ("Step 4 must occur after both steps 1 and 3 are finished.", "1>4 3>4"),
    ("You should do step 1 before you do step 4.", "1>4"),
    ("Step 5 is done after everything else.", "1>5 2>5 3>5 4>5"),
    ("Step 5 must be done after all the other steps.", "1>5 2>5 3>5 4>5"),
]

REFUSED = [
    ("First, do step 1. Then do steps 2 and 3. Finally, do step 5.", "IRC021", 8, 42),
    ("Step 4 can start 10 minutes after step 1.", "IRC021", 8, 1),
    ("You can only cook the pasta once you have boiled the water.", "IRC023", 8, 9),
    ("Step 1 need not precede step 4.", "IRC023", 8, 13),
    ("Step 1 does not have to precede step 4.", "IRC023", 8, 13),
    ("Step 1 usually precedes step 4.", "IRC022", 8, 8),
    ("Step 1 should ideally precede step 4.", "IRC022", 8, 15),
    ("Step 1 must precede step 4 unless step 2 is done.", "IRC023", 8, 28),
    ("Step 1 must precede step 4 if possible.", "IRC022", 8, 28),
    ("All steps except step 4 must precede step 5.", "IRC023", 8, 11),
    ("Step 1 or step 2 must precede step 3.", "IRC023", 8, 8),
    ("Either step 1 or step 2 must precede step 4.", "IRC023", 8, 1),
    ("Step 1 may precede step 4.", "IRC020", 8, 1),
    ("Step 1 can be done before step 4.", "IRC021", 8, 1),
    ("Step 1 must not precede step 4.", "IRC023", 8, 13),
    ("Step 1 must precede step 9.", "IRC024", 8, 21),
    ("Steps 1 to 9 must precede step 4.", "IRC024", 8, 1),
    ("Only one person is available.", "IRC028", 8, 1),
    ("There is only one stove.", "IRC028", 8, 1),
    ("Assume one cook does everything.", "IRC028", 8, 1),
    ("Steps 1 and 4 both need the stove.", "IRC028", 8, 1),
    ("Step 4 takes about 12 minutes.", "IRC022", 8, 14),
    ("Step 4 takes 20 minutes.", "IRC027", 8, 1),
    ("Steps 1 and 2 must precede steps 3 and 4, respectively.", "IRC023", 8, 43),
    ("Step 1 must precede step 4, probably.", "IRC022", 8, 29),
    ("Step 1 must precede step 2 and maybe step 3.", "IRC022", 8, 32),
    ("Step 3 must start before step 4.", "IRC021", 8, 1),
    ("Step 3 must be finished after step 2.", "IRC021", 8, 1),
    ("Step 4 must start soon after step 1.", "IRC022", 8, 19),
    ("The weather is nice today.", "IRC020", 8, 1),
    ("Step 1 must precede step 4 and the weather is nice.", "IRC020", 8, 1),
    ("If it rains, step 1 must precede step 4.", "IRC023", 8, 1),
    ("Steps 2, 3 and 4 cannot be done at the same time.", "IRC021", 8, 1),
    ("Then do step 3.", "IRC021", 8, 1),
    ("It must precede step 4.", "IRC021", 8, 1),
    ("Step 1 must step 4.", "IRC020", 8, 1),
    ("Step must precede step 4.", "IRC020", 8, 1),
    ("must precede step 4.", "IRC020", 8, 1),
    ("Step 1 must precede.", "IRC020", 8, 1),
    ("Step 1 must precede step.", "IRC020", 8, 1),
    ("Step 1 must precede step 4 step 5.", "IRC020", 8, 1),
    ("Step 1 must not be started until step 3.", "IRC023", 8, 13),
    ("Step 1 is not required before step 4.", "IRC023", 8, 11),
    ("Step 1 must precede step 4 only on Mondays.", "IRC023", 8, 28),
    ("Not step 1 but step 2 must precede step 4.", "IRC023", 8, 1),
    ("Step 1 must never precede step 4.", "IRC023", 8, 13),
    ("Step 4 cannot start after step 1.", "IRC020", 8, 1),
    ("Step 1 must precede some of the other steps.", "IRC022", 8, 21),
    ("Most steps must precede step 5.", "IRC020", 8, 1),
    ('"Boil the wine" must precede step 4.', "IRC024", 8, 1),
    ("Step 1 must precede step 4?", "IRC020", 8, 1),
    ("Must step 1 precede step 4?", "IRC020", 8, 1),
    ("Step 1,000 must precede step 4.", "IRC021", 8, 1),
    ("Step 1.5 must precede step 4.", "IRC021", 8, 1),
    ("Step 1 must precede step 4 and not step 5.", "IRC023", 8, 32),
    ("Step 1 must precede step 4 but not step 5.", "IRC023", 8, 32),
    ("Step 2 and 3 must precede step 4 or step 5.", "IRC023", 8, 34),
]


@pytest.mark.slow
@pytest.mark.parametrize(("sentence", "meant"), READ, ids=[s for s, _ in READ])
def test_a_sentence_is_read_as_it_says(sentence: str, meant: str) -> None:
    assert order(irc.loads(FIVE_STEPS + sentence).ir) == meant


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentence", "code", "line", "column"), REFUSED, ids=[row[0] for row in REFUSED]
)
def test_an_inexact_sentence_is_refused_at_its_place(
    sentence: str, code: str, line: int, column: int
) -> None:
    assert first_error(FIVE_STEPS + sentence) == (code, line, column)


def test_every_sentence_that_is_not_understood_is_told_in_one_run() -> None:
    text = FIVE_STEPS + "Blah one.\nStep 1 must precede step 2.\nBlah two. Blah three."
    with pytest.raises(irc.InputError) as caught:
        irc.loads(text)
    places = [(d.line, d.column) for d in caught.value.report.located()]
    assert places == [(8, 1), (10, 1), (10, 11)]


def test_a_diagnostic_quotes_the_sentence_and_says_what_is_understood() -> None:
    with pytest.raises(irc.InputError) as caught:
        irc.loads(FIVE_STEPS + "The weather is nice.")
    (found,) = caught.value.report
    assert '"The weather is nice"' in found.message
    assert "Step 1 must precede" in (found.hint or "")
