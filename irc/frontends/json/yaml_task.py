"""Reads a task that stands as YAML in the place of JSON, so that all its faults are found at once.

The IR is no YAML: the document is refused, with the JSON that means the same as its repair. Scalars
are read as YAML 1.2 does (`yes` is a text, `1:30` is not a number). Anchors are refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.fix import TextEdit, plain
from irc.diagnostics.source import Pointer, Range, Source

if TYPE_CHECKING:
    from yaml import Node

MOST_CHARACTERS = 200_000
"""Longer texts are not read as YAML, which takes long."""

_MOST_LEVELS = 64
_FENCED = re.compile(r"^```ya?ml[ \t]*\n(.*?)^```[ \t]*$", re.DOTALL | re.MULTILINE | re.IGNORECASE)
_TASK = re.compile(
    r"^[ \t]*[\"']?(?:actions|tasks|steps|activities|operations|jobs)[\"']?[ \t]*:[ \t]*(?:#.*)?\n"
    r"(?:[ \t]*(?:#.*)?\n)*[ \t]*-[ \t]+"
    r"(?:\{|[\"']?(?:id|name|action|task|step|title|label|key|duration)[\"']?[ \t]*:)",
    re.MULTILINE,
)
_KEY_LINE = re.compile(r"^[A-Za-z_][\w -]*:(?:[ \t]|$)", re.MULTILINE)
_WHOLE = re.compile(r"[-+]?[0-9]{1,1000}", re.ASCII)
_DECIMAL = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]{1,6})?", re.ASCII)
_WORDS = {"true": True, "false": False, "null": None, "~": None, "": None}


def is_yaml(text: str, name: str = "") -> bool:
    """Whether a text holds a task as YAML: by its name or its fence, or a list of actions in it."""
    if name.lower().endswith((".yaml", ".yml")):
        return True
    fenced = _FENCED.search(text)
    return (fenced is not None and _KEY_LINE.search(fenced[1]) is not None) or (
        _TASK.search(text) is not None
    )


def yaml_task(text: str, name: str) -> tuple[dict[str, Any], Source, Findings]:
    """(the document, the text as a source that knows its elements, findings: it is YAML).

    Raises `InputError` with the place where the text is not YAML either.
    """
    begin, end = _extent(text)
    root = _composed(text, begin, end, name)
    content = _value(root)
    findings = Findings()
    if not isinstance(content, dict):
        raise _fault(text, name, begin, "this is YAML without fields; a task is a JSON object")
    from irc.schedule import dump_json

    findings.add(
        Code.SYNTAX,
        "this is YAML; a task is JSON, the DSL or sentences",
        offset=begin,
        hint='write {"actions": [{"id": "…", "duration": 5}]}; `irc check --fix` does',
        edits=(TextEdit(*_with_fence(text, begin, end), dump_json(plain(content))),),
    )
    return content, Source(name, text, _Places(begin, end)), findings


def _extent(text: str) -> tuple[int, int]:
    """[begin, end) of the YAML: inside a code fence, else from the first key on."""
    fences = list(_FENCED.finditer(text))
    for fenced in sorted(fences, key=lambda f: _TASK.search(f[1]) is None):
        if _KEY_LINE.search(fenced[1]):
            return fenced.span(1)
    first = _KEY_LINE.search(text)
    fence = text.find("\n```", first.start() if first else 0)
    return (first.start() if first else 0), (len(text) if fence < 0 else fence + 1)


def _with_fence(text: str, begin: int, end: int) -> tuple[int, int]:
    """The extent with a fence around it that calls it YAML."""
    fenced = next((f for f in _FENCED.finditer(text) if f.span(1) == (begin, end)), None)
    return (begin, end) if fenced is None else fenced.span()


def _composed(text: str, begin: int, end: int, name: str) -> Node:
    import yaml

    if end - begin > MOST_CHARACTERS:
        message = f"YAML of more than {MOST_CHARACTERS:,} characters is not read"
        raise _fault(text, name, begin, message, Code.TOO_LARGE)
    part = text[begin:end]
    try:
        for event in yaml.parse(part, yaml.SafeLoader):
            if isinstance(event, yaml.AliasEvent):
                message = "an alias of YAML; write out what it stands for"
                start = event.start_mark
                raise _fault(text, name, begin + (0 if start is None else start.index), message)
        root = yaml.compose(part, yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        at = begin if mark is None else min(begin + mark.index, max(end - 1, 0))
        raise _fault(text, name, at, f"neither JSON nor YAML: {error.problem}") from None
    except yaml.YAMLError as error:
        raise _fault(text, name, begin, f"neither JSON nor YAML: {error}") from None
    except RecursionError:
        raise _fault(text, name, begin, "nested too deeply", Code.TOO_LARGE) from None
    if root is None or _depth(root) > _MOST_LEVELS:
        message = f"nested more than {_MOST_LEVELS} levels deep" if root else "the input is empty"
        raise _fault(text, name, begin, message, Code.TOO_LARGE if root else Code.SYNTAX)
    _require_unique_keys(root, text, name, begin)
    return root


def _fault(text: str, name: str, at: int, message: str, code: Code = Code.SYNTAX) -> InputError:
    findings = Findings()
    hint = 'expected a task such as {"actions": [{"id": "a", "duration": 3}]}'
    findings.add(code, message, offset=at, hint=hint)
    return InputError(Report(tuple(findings.items), Source(name, text)))


def _depth(root: Node) -> int:
    level, depth = [root], 0
    while level and depth <= _MOST_LEVELS:
        depth += 1
        level = [inner for outer in level for _, _, inner in _members(outer)]
    return depth


def _require_unique_keys(root: Node, text: str, name: str, begin: int) -> None:
    level = [root]
    while level:
        for node in level:
            seen: set[str | int] = set()
            for key, place, _ in _members(node):
                if key in seen:
                    message = f"the key {key!r} appears twice in this object"
                    at = begin + place.start_mark.index
                    raise _fault(text, name, at, message, Code.DUPLICATE_KEY)
                seen.add(key)
        level = [inner for outer in level for _, _, inner in _members(outer)]


def _members(node: Node) -> Iterator[tuple[str | int, Node, Node]]:
    """(key or index, node of the key, node of the value) of a mapping or sequence."""
    import yaml

    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            yield str(key.value) if isinstance(key, yaml.ScalarNode) else "?", key, value
    elif isinstance(node, yaml.SequenceNode):
        for index, value in enumerate(node.value):
            yield index, value, value


def _value(node: Node) -> Any:
    import yaml

    if isinstance(node, yaml.MappingNode):
        return {key: _value(inner) for key, _, inner in _members(node)}
    if isinstance(node, yaml.SequenceNode):
        return [_value(inner) for _, _, inner in _members(node)]
    return _scalar(node)


def _scalar(node: Any) -> Any:
    text: str = node.value
    if node.style is not None:
        return text
    if text.lower() in _WORDS and (text.islower() or text.istitle() or text in _WORDS):
        return _WORDS[text.lower()]
    if _WHOLE.fullmatch(text):
        return int(text)
    return Decimal(text) if _DECIMAL.fullmatch(text) else text


@dataclass(frozen=True)
class _Places:
    """Finds the elements of the YAML in [begin, end) of a text."""

    begin: int
    end: int

    def __call__(self, text: str, wanted: frozenset[Pointer]) -> Mapping[Pointer, Range]:
        import yaml

        root = yaml.compose(text[self.begin : self.end], yaml.SafeLoader)
        places: dict[Pointer, Range] = {}
        waiting: list[tuple[Pointer, Node | None, Node]] = (
            [] if root is None else [((), None, root)]
        )
        while waiting:
            pointer, key, node = waiting.pop()
            if pointer in wanted:
                places[pointer] = self._range(pointer, key, node)
            for name, place, inner in _members(node):
                mark = place if isinstance(name, str) else None
                waiting.append(((*pointer, name), mark, inner))
        return places

    def _range(self, pointer: Pointer, key: Node | None, node: Node) -> Range:
        start = self.begin + node.start_mark.index
        end = self.begin + node.end_mark.index
        at_key = None if key is None else self.begin + key.start_mark.index
        return Range(start, end, at_key, written=pointer)
