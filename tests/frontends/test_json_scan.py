"""The scanner agrees with `json` about what stands where and about where a text goes wrong."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irc.diagnostics import Code
from irc.diagnostics.source import Pointer, Source, pointer_text
from irc.frontends.files import parse_task
from irc.frontends.json.scan import MAX_FAULTS, Scan, scan

texts = st.text(max_size=6) | st.sampled_from(['"', "\\", "/", "~1", "\n", "é", "🤖", "a,b", "]"])
values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | texts,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=4),
    max_leaves=12,
)
DECODER = json.JSONDecoder()


def printed(value: Any, rng: random.Random) -> str:
    """`value` as JSON with white space and escapes wherever JSON allows them."""

    def space() -> str:
        return "".join(rng.choices(" \t\n\r", k=rng.choice((0, 0, 1, 3))))

    def one(value: Any) -> str:
        if isinstance(value, dict):
            members = (f"{one(k)}{space()}:{space()}{one(v)}" for k, v in value.items())
            return "{" + space() + f"{space()},{space()}".join(members) + space() + "}"
        if isinstance(value, list):
            return "[" + space() + f"{space()},{space()}".join(map(one, value)) + space() + "]"
        return json.dumps(value, ensure_ascii=rng.random() < 0.5)

    return space() + one(value) + space()


def elements(value: Any, at: Pointer = ()) -> Iterator[tuple[Pointer, Any]]:
    """Every element of a document with its path."""
    yield at, value
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from elements(inner, (*at, key))
    elif isinstance(value, list):
        for k, inner in enumerate(value):
            yield from elements(inner, (*at, k))


# --- places -------------------------------------------------------------------------------------


@pytest.mark.slow
@given(values, st.randoms(use_true_random=False))
def test_the_text_at_each_place_is_the_element(value: Any, rng: random.Random) -> None:
    text = printed(value, rng)
    known = dict(elements(value))
    found = scan(text, wanted=known.keys())
    assert found.faults == []
    assert found.places.keys() == known.keys()
    assert text[found.end :].strip() == ""
    for pointer, place in found.places.items():
        assert json.loads(text[place.start : place.end]) == known[pointer]
        if pointer and isinstance(pointer[-1], str):
            assert place.key_start is not None
            key, end = DECODER.raw_decode(text, place.key_start)
            assert key == pointer[-1]
            assert text[end : place.start].strip() == ":"
        else:
            assert place.key_start is None


@pytest.mark.slow
@given(values, st.randoms(use_true_random=False))
def test_only_wanted_elements_are_placed(value: Any, rng: random.Random) -> None:
    wanted = {pointer for pointer, _ in elements(value) if rng.random() < 0.3}
    assert scan(printed(value, rng), wanted=wanted).places.keys() == wanted


def test_a_scan_can_begin_within_a_text() -> None:
    text = 'the plan: {"a": 1} and more'
    found = scan(text, 10, {("a",)})
    assert text[found.places[("a",)].start] == "1"
    assert text[: found.end].endswith("}")
    assert found.faults == []


def test_of_a_repeated_key_the_first_place_counts_and_the_second_is_told() -> None:
    text = '{"a": 1, "\\u0061": 2}'
    found = scan(text, wanted={("a",)})
    assert text[found.places[("a",)].start] == "1"
    assert [(f.code, f.offset) for f in found.faults] == [(Code.DUPLICATE_KEY, 9)]


def test_lines_and_columns_count_characters() -> None:
    text = '{\n  "é🤖": [\n\t1,\r\n  22]\n}'
    source = Source("file", text, lambda text, wanted: scan(text, wanted=wanted).places)
    places = source.locate([("é🤖",), ("é🤖", 0), ("é🤖", 1), ("é🤖", 7), ("nothing",)])
    starts = {p: r and source.line_and_column(r.start) for p, r in places.items()}
    assert starts == {
        ("é🤖",): (2, 9),
        ("é🤖", 0): (3, 2),
        ("é🤖", 1): (4, 3),
        ("é🤖", 7): (2, 9),
        ("nothing",): (1, 1),
    }
    assert source.line_at(source.text.index("1,")) == "\t1,"


def test_a_pointer_is_written_as_in_rfc_6901() -> None:
    assert pointer_text(("a/b", 3, "m~n", "")) == "/a~1b/3/m~0n/"
    assert pointer_text(()) == ""


# --- faults -------------------------------------------------------------------------------------

CUT_OFF = "the text ends inside the JSON document"
COMMA = "a comma before"
NOT_CLOSED = "the string that begins here is not closed"
CUT_ESCAPE = re.compile(r"\\(u[0-9a-fA-F]{0,4})?\Z")


def damaged(text: str, rng: random.Random) -> str:
    """`text` with one character removed, doubled, replaced or inserted, or its end cut off."""
    at = rng.randrange(len(text)) if text else 0
    noise = rng.choice(
        ["{", "}", "[", "]", ",", ":", '"', "\\", "x", "1", "-", " ", "\n", "٢", "é"]
    )
    ways = (
        text[:at] + text[at + 1 :],
        text[:at] + text[at : at + 1] + text[at:],
        text[:at] + noise + text[at + 1 :],
        text[:at] + noise + text[at:],
        text[:at],
    )
    return rng.choice(ways)


def judged(text: str) -> json.JSONDecodeError | None:
    """What `json` says of the first value in a text."""
    start = len(text) - len(text.lstrip(" \t\n\r"))
    try:
        DECODER.raw_decode(text, start)
    except json.JSONDecodeError as error:
        return error
    return None


def agree(text: str, error: json.JSONDecodeError | None, found: Scan) -> bool:
    """Whether the scanner's first syntax error is json's, but for where three of them are told.

    A text that ends too soon is told at its last character (within an escape: where its string
    begins), a comma too many at the comma, and a bad escape at its backslash.
    """
    # The standard library lets half a character pass; the scanner does not.
    faults = [f for f in found.faults if f.code is Code.SYNTAX and "half a" not in f.message]
    if error is None or not faults:
        return error is None and not faults
    told = faults[0]
    if told.message == CUT_OFF:
        return told.offset == max(0, len(text.rstrip()) - 1) and error.pos >= told.offset
    if told.message.startswith(COMMA):
        return text[told.offset] == "," and not text[told.offset + 1 : error.pos].strip(" \t\n\r]}")
    if told.message.startswith(r"the escape '\u'"):
        return text[told.offset] == "\\" and told.offset <= error.pos <= told.offset + 2
    if told.message == NOT_CLOSED and (CUT_ESCAPE.search(text) or "control" in error.msg):
        # (Of a text that nothing closes, its begin is told; json stops at a tab in it.)
        return text[told.offset] == '"' and told.offset <= error.pos
    return told.offset == error.pos


@pytest.mark.slow
@settings(max_examples=125)
@given(st.lists(values, max_size=3) | st.dictionaries(texts, values, max_size=3), st.randoms())
def test_a_damaged_text_is_at_fault_where_json_says(value: Any, rng: random.Random) -> None:
    text = damaged(printed(value, rng), rng)
    error, found = judged(text), scan(text)
    assert agree(text, error, found), (text, error, found.faults)


@pytest.mark.parametrize(
    ("text", "at", "message"),
    [
        ("", 0, CUT_OFF),
        ("  ", 0, CUT_OFF),
        ('{"a": 1', 6, CUT_OFF),
        ('{"a": 1  \n ', 6, CUT_OFF),
        ('{"a":', 4, CUT_OFF),
        ('{"a', 1, NOT_CLOSED),
        ('{"a": "x', 6, NOT_CLOSED),
        ('{"a": "x\\', 6, NOT_CLOSED),
        ('{"a": "x\\u00', 6, NOT_CLOSED),
        ("{a: 1}", 1, "expected a key in double quotes, found 'a: 1}'"),
        ("{'a': 1}", 1, "expected a key in double quotes"),
        ('{"a" 1}', 5, "expected ':' after the key, found '1}'"),
        ('{"a": 1 "b": 2}', 8, "expected ',' or '}', found"),
        ("[1 2]", 3, "expected ',' or ']', found '2]'"),
        ("[1}", 2, "expected ',' or ']', found '}'"),
        ("[1,]", 2, "a comma before ']'"),
        ('{"a": 1, }', 7, "a comma before '}'"),
        ("[,1]", 1, "expected a value, found ',1]'"),
        ("[01]", 2, "expected ',' or ']'"),
        ("[1.]", 2, "expected ',' or ']'"),
        ("[.5]", 1, "expected a value, found '.5]'"),
        ("[+1]", 1, "expected a value, found '+1]'"),
        ("[1٢]", 2, "expected ',' or ']'"),
        ("[True]", 1, "expected a value, found 'True]'"),
        ("[undefined]", 1, "expected a value"),
        (r'["\x"]', 2, r"the escape '\x' does not exist in JSON"),
        (r'["\u12"]', 2, r"the escape '\u' does not exist in JSON"),
        ('["a\nb"]', 3, "a line break or control character inside a string"),
    ],
)
def test_each_syntax_error_has_words_and_a_place(text: str, at: int, message: str) -> None:
    (fault,) = scan(text).faults
    assert (fault.code, fault.offset) == (Code.SYNTAX, at)
    assert fault.message.startswith(message)


def test_what_is_left_open_is_named_with_its_line() -> None:
    (fault,) = scan('{\n "a": [1,\n 2').faults
    assert fault.hint == "the array '[' of line 2 is not closed; the text was probably cut off"


@pytest.mark.parametrize(
    "number", ["NaN", "Infinity", "-Infinity", "nan", "-inf", "1e9999999", "1" * 1001]
)
def test_a_number_json_does_not_have_is_told_and_read_past(number: str) -> None:
    found = scan(f"[1, {number}, 2, {number}]")
    assert [f.code for f in found.faults] == [Code.BAD_NUMBER] * 2
    assert found.faults[0].offset == 4
    assert found.end == len(f"[1, {number}, 2, {number}]")


def test_faults_without_end_are_not_all_told() -> None:
    faults = scan("[" + "NaN," * 5000 + "1]").faults
    assert len(faults) == MAX_FAULTS + 1
    assert faults[-1].code is Code.TOO_LARGE


@pytest.mark.parametrize("opening", ["[", '{"a":'])
def test_deep_nesting_is_refused_without_recursion(opening: str) -> None:
    (fault,) = scan(opening * 100_000, max_depth=64).faults
    assert (fault.code, fault.offset) == (Code.TOO_LARGE, 64 * len(opening))


@pytest.mark.slow
@pytest.mark.parametrize(
    "text", ['["' + "a" * 300_000, '["' + r"\n" * 200_000, "[" + "1," * 200_000]
)
def test_a_long_damaged_text_is_read_once(text: str) -> None:
    assert len(scan(text).faults) == 1


# --- through the front door ---------------------------------------------------------------------


@pytest.mark.slow
@settings(max_examples=100)
@given(st.randoms())
def test_a_damaged_task_is_never_taken_for_another(rng: random.Random) -> None:
    """Whatever one slip of a key does to a task, it is refused, or means what json says."""
    from irc.diagnostics import InputError
    from irc.model import Task

    document = {"actions": [{"id": "a", "duration": 12}], "precedence": []}
    text = damaged(printed(document, rng).strip(), rng)
    try:
        task = parse_task(text).task
    except InputError as error:
        told = error.report.located().errors
    else:
        assert task == Task.model_validate(DECODER.raw_decode(text, text.index("{"))[0])
        return
    assert told
    assert all(diagnostic.line is not None for diagnostic in told)
