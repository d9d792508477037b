"""A YAML or JSON text as plain values, with the place in the file of each of them.

Every scalar stays the text that was written: ``no``, ``12:30``, ``017`` and ``2024-01-05`` arrive
as such, and the scene model's types decide what they are.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from geotween.scene.errors import Fault, SceneError

Location = tuple[str | int, ...]

MAX_DEPTH = 200  # nested brackets; beyond some 10,000 the parser itself would break
MAX_EXPANSION = 5_000_000  # values after aliases are expanded; stops an alias bomb
_NULLS = frozenset({"", "~", "null"})
_STANDARD_TAG = "tag:yaml.org,2002:"
_PLAIN_TAGS = frozenset(
    _STANDARD_TAG + name
    for name in ["null", "bool", "int", "float", "timestamp", "str", "seq", "map", "merge", "value"]
)
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True)
class Document:
    """A file that was read: its name as the user wrote it, its text, and places in it."""

    name: str
    path: Path
    text: str

    @cached_property
    def lines(self) -> list[str]:
        return self.text.splitlines()

    @cached_property
    def root(self) -> yaml.Node | None:
        """The node tree of the text.

        Raises
        ------
        SceneError
            Where the text is not YAML.
        """
        if _nested_too_deeply(self.text):
            raise SceneError([self.fault_at(1, 1, f"nested more than {MAX_DEPTH} levels deep")])
        loader = _Loader(self.text)
        try:
            return _flattened(loader, loader.get_single_node())
        except yaml.MarkedYAMLError as error:
            raise SceneError([self._broken(error)]) from None
        except yaml.reader.ReaderError as error:
            line, column = self._place_of(int(error.position))
            code = error.character if isinstance(error.character, int) else ord(error.character)
            message = f"the character U+{code:04X} may not stand in YAML"
            raise SceneError([self.fault_at(line, column, message, "remove it")]) from None
        finally:
            loader.dispose()

    def fault(
        self, location: Location, message: str, hint: str = "", *, at_key: bool = False
    ) -> Fault:
        """A fault at a value (or at the key of that value), as near as the file knows it."""
        return self.fault_at(*self.place(location, at_key=at_key), message, hint)

    def fault_at(self, line: int, column: int, message: str, hint: str = "") -> Fault:
        text = self.lines[line - 1] if 0 < line <= len(self.lines) else ""
        return Fault(self.name, line, column, message, hint, text)

    def place(self, location: Location, *, at_key: bool = False) -> tuple[int, int]:
        """Line and column, from 1, of a value; of its nearest holder where it is absent."""
        try:
            node = self.root
        except SceneError:  # JSON that is not YAML too (a tab, say)
            return 1, 1
        mark = node.start_mark if node is not None else None
        for step in location:
            found = _child(node, step)
            if found is None:
                break
            key, node = found
            mark = key.start_mark if at_key and step == location[-1] else node.start_mark
        return (mark.line + 1, mark.column + 1) if mark is not None else (1, 1)

    def _broken(self, error: yaml.MarkedYAMLError) -> Fault:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        while line > 1 and (line > len(self.lines) or not self.lines[line - 1].strip()):
            line -= 1  # the parser stops at the end of the file; show the last line written
            column = len(self.lines[line - 1]) + 1 if line <= len(self.lines) else 1
        problem = error.problem or error.context or "cannot be read"
        context = f" ({error.context})" if error.problem and error.context else ""
        return self.fault_at(line, column, f"this is not YAML: {problem}{context}", _hint(problem))

    def _place_of(self, position: int) -> tuple[int, int]:
        before = self.text[:position]
        return before.count("\n") + 1, position - before.rfind("\n")


def read_text(path: Path, name: str, *, named_by: Fault | None = None) -> str:
    """The text of a UTF-8 file.

    Raises
    ------
    SceneError
        At the place that names the file (``named_by``) where it cannot be opened; in the file
        itself where it is not UTF-8.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        text = f"cannot read {name}: {reason}"
        if named_by is None:
            raise SceneError([Fault(name, 1, 1, text)]) from None
        hint = _similar_file(path)
        fault = Fault(named_by.file, named_by.line, named_by.column, text, hint, named_by.text)
        raise SceneError([fault]) from None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = raw[: error.start]
        line, column = before.count(b"\n") + 1, error.start - before.rfind(b"\n")
        message = f"the byte 0x{raw[error.start]:02X} is not UTF-8"
        raise SceneError([Fault(name, line, column, message, "save the file as UTF-8")]) from None


def read_yaml(document: Document) -> Any:
    """The document as dicts, lists, texts and None; keys without a value are left out.

    Raises
    ------
    SceneError
        For broken YAML, duplicate keys, keys that are not text, foreign tags, loops of aliases.
    """
    reader = _Reader(document)
    value = reader.value(document.root)
    if reader.faults:
        raise SceneError(sorted(reader.faults))
    return value


def read_json(document: Document) -> Any:
    """The document parsed as JSON.

    Raises
    ------
    SceneError
        Where it is not JSON.
    """
    try:
        return json.loads(document.text)
    except json.JSONDecodeError as error:
        hint = "the file is empty" if not document.text.strip() else "expected GeoJSON"
        fault = document.fault_at(error.lineno, error.colno, f"not JSON: {error.msg}", hint)
        raise SceneError([fault]) from None
    except RecursionError:
        raise SceneError([document.fault_at(1, 1, "nested too deeply")]) from None


class _Reader:
    """Turns nodes into values, each shared node once, and notes what is wrong on the way."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.faults: list[Fault] = []
        self._done: dict[int, tuple[Any, int]] = {}
        self._open: set[int] = set()
        self._expansion_reported = False

    def value(self, node: yaml.Node | None) -> Any:
        return None if node is None else self._convert(node)[0]

    def _convert(self, node: yaml.Node) -> tuple[Any, int]:
        """The value of a node, and how many values it holds once aliases are expanded."""
        if isinstance(node, yaml.ScalarNode):
            self._check_tag(node)
            plain_null = not node.style and node.value in _NULLS
            return (None if plain_null else node.value), 1
        if id(node) in self._done:
            return self._done[id(node)]
        if id(node) in self._open:
            self._note(node, "an alias may not stand inside what it names")
            return None, 1
        self._open.add(id(node))
        self._check_tag(node)
        result = self._mapping(node) if isinstance(node, yaml.MappingNode) else self._list(node)
        self._open.discard(id(node))
        self._done[id(node)] = result
        if result[1] > MAX_EXPANSION and not self._expansion_reported:
            self._expansion_reported = True
            self._note(node, f"aliases expand to more than {MAX_EXPANSION:,} values")
        return result

    def _mapping(self, node: yaml.MappingNode) -> tuple[dict[str, Any], int]:
        values: dict[str, Any] = {}
        seen: dict[str, yaml.Node] = {}
        size = 1
        for key, child in node.value:
            if not isinstance(key, yaml.ScalarNode):
                self._note(key, "a key must be a text")
                continue
            if key.value in seen:
                line = seen[key.value].start_mark.line + 1
                self._note(
                    key,
                    f'the key "{key.value}" stands twice',
                    f"it is already set in line {line}; keep one of the two",
                )
                continue
            seen[key.value] = key
            value, count = self._convert(child)
            size += count
            if value is not None:
                values[key.value] = value
        return values, size

    def _list(self, node: yaml.Node) -> tuple[list[Any], int]:
        converted = [self._convert(child) for child in node.value]
        return [value for value, _ in converted], 1 + sum(count for _, count in converted)

    def _check_tag(self, node: yaml.Node) -> None:
        if node.tag not in _PLAIN_TAGS:
            tag = node.tag.replace(_STANDARD_TAG, "!!")
            self._note(node, f"the tag {tag} has no meaning in a scene", "remove it")

    def _note(self, node: yaml.Node, message: str, hint: str = "") -> None:
        mark = node.start_mark
        self.faults.append(self.document.fault_at(mark.line + 1, mark.column + 1, message, hint))


def _child(node: yaml.Node | None, step: str | int) -> tuple[yaml.Node, yaml.Node] | None:
    """The key node and value node that a location's step leads to."""
    if isinstance(node, yaml.SequenceNode) and isinstance(step, int):
        if 0 <= step < len(node.value):
            return node.value[step], node.value[step]
    elif isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            if isinstance(key, yaml.ScalarNode) and key.value == str(step):
                return key, value
    return None


def _flattened(loader: Any, root: yaml.Node | None) -> yaml.Node | None:
    """Resolve merge keys (``<<: *base``); what a mapping says itself comes before what it merges.

    Only the merged keys are deduplicated here, so that a key written twice stays an error.
    """
    seen: set[int] = set()
    stack = [root]
    while stack:
        node = stack.pop()
        if not isinstance(node, yaml.CollectionNode) or id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, yaml.MappingNode):
            if any(key.tag == _STANDARD_TAG + "merge" for key, _ in node.value):
                own = [pair for pair in node.value if pair[0].tag != _STANDARD_TAG + "merge"]
                named = {key.value for key, _ in own if isinstance(key, yaml.ScalarNode)}
                loader.flatten_mapping(node)
                merged = node.value[: len(node.value) - len(own)]
                latest = {key.value: (key, value) for key, value in merged}
                node.value = [p for name, p in latest.items() if name not in named] + own
            stack.extend(child for pair in node.value for child in pair)
        else:
            stack.extend(node.value)
    return root


def _nested_too_deeply(text: str) -> bool:
    """Whether brackets nest beyond MAX_DEPTH; the parser is asked only where a scan suspects it."""
    scan = (1 if c in "[{" else -1 for c in re.findall(r"[\[\]{}]", text))
    if _highest(scan) <= MAX_DEPTH and not re.search(rf"(?:[-?:] +){{{MAX_DEPTH},}}", text):
        return False
    try:
        return _highest(_nesting(text)) > MAX_DEPTH
    except yaml.YAMLError:
        return False  # the composer meets the same error, and reports it with its place


def _highest(changes: Iterator[int]) -> int:
    depth = highest = 0
    for change in changes:
        depth += change
        highest = max(highest, depth)
        if highest > MAX_DEPTH:
            break
    return highest


def _nesting(text: str) -> Iterator[int]:
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.CollectionStartEvent):
            yield 1
        elif isinstance(event, yaml.CollectionEndEvent):
            yield -1


def _hint(problem: str) -> str:
    if "mapping values" in problem:
        return 'a text with a colon in it needs quotes: "Area: 12 ha"'
    if "tab" in problem or "cannot start any token" in problem:
        return "indent with spaces, not tabs; a text that begins with @, ` or % needs quotes"
    if "expected ',' or ']'" in problem or "expected ',' or '}'" in problem:
        return "a bracket is not closed, or a comma is missing"
    if "single document" in problem:
        return "one scene a file: remove the line ---"
    return "check brackets, quotes and indentation"


def _similar_file(path: Path) -> str:
    import difflib

    if not path.parent.is_dir():
        return f"there is no folder {path.parent.name}/ there"
    names = [entry.name for entry in path.parent.iterdir()]
    near = difflib.get_close_matches(path.name, names, n=1)
    return f'did you mean "{near[0]}"?' if near else "paths are relative to the scene file"
