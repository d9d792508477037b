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
from typing import Any, NamedTuple

import yaml

from geotween.scene.errors import Fault, SceneError

Location = tuple[str | int, ...]

MAX_DEPTH = 200  # levels; each takes three of Python's 1,000 calls on the stack
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
            root: yaml.Node | None = loader.get_single_node()
            _merge(root, set())
            return root
        except yaml.MarkedYAMLError as error:
            raise SceneError([self._broken(error)]) from None
        except yaml.reader.ReaderError as error:
            code = error.character if isinstance(error.character, int) else ord(error.character)
            line, column = self.place_of(self.text.index(chr(code)))
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
        problem = (error.problem or error.context or "cannot be read").removeprefix("but ")
        context = f" ({error.context})" if error.problem and error.context else ""
        return self.fault_at(line, column, f"this is not YAML: {problem}{context}", _hint(problem))

    def place_of(self, position: int) -> tuple[int, int]:
        """Line and column, from 1, of a position in the text."""
        lines = f"{self.text[:position]}|".splitlines()
        return len(lines), len(lines[-1])


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
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        reason = str(getattr(error, "strerror", None) or error).lower()
        text = f"cannot read {name}: {reason}"
        if named_by is None:
            raise SceneError([Fault(name, 1, 1, text)]) from None
        hint = _similar_file(path)
        fault = Fault(named_by.file, named_by.line, named_by.column, text, hint, named_by.text)
        raise SceneError([fault]) from None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = error.object[: error.start].decode()  # without a byte order mark
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        message = f"the byte 0x{error.object[error.start]:02X} is not UTF-8"
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
        place = document.place_of(error.pos)
        raise SceneError([document.fault_at(*place, f"not JSON: {error.msg}", hint)]) from None
    except ValueError:  # Python reads no whole number of more than 4,300 digits
        raise SceneError([document.fault_at(1, 1, "a number has too many digits")]) from None
    except RecursionError:
        raise SceneError([document.fault_at(1, 1, "nested too deeply")]) from None


class _Converted(NamedTuple):
    """A node's value; how many values it holds, and how deep, once aliases are expanded."""

    value: Any
    size: int = 1
    depth: int = 0


class _Reader:
    """Turns nodes into values, each shared node once, and notes what is wrong on the way."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.faults: list[Fault] = []
        self._done: dict[int, _Converted] = {}
        self._open: set[int] = set()
        self._expansion_reported = False

    def value(self, node: yaml.Node | None) -> Any:
        return None if node is None else self._convert(node).value

    def _convert(self, node: yaml.Node) -> _Converted:
        if isinstance(node, yaml.ScalarNode):
            self._check_tag(node)
            plain_null = not node.style and node.value in _NULLS
            return _Converted(None if plain_null else node.value)
        if id(node) in self._done:
            return self._done[id(node)]
        if id(node) in self._open:
            self._note(node, "an alias may not stand inside what it names")
            return _Converted(None)
        self._open.add(id(node))
        self._check_tag(node)
        result = self._mapping(node) if isinstance(node, yaml.MappingNode) else self._list(node)
        self._open.discard(id(node))
        self._done[id(node)] = result
        self._check_expansion(node, result)
        return result

    def _mapping(self, node: yaml.MappingNode) -> _Converted:
        values: dict[str, Any] = {}
        seen: dict[str, yaml.Node] = {}
        size = depth = 1
        for key, child in node.value:
            if not isinstance(key, yaml.ScalarNode):
                self._note(key, "a key must be a text")
                continue
            self._check_tag(key)
            if key.value in seen:
                line = seen[key.value].start_mark.line + 1
                self._note(
                    key,
                    f'the key "{key.value}" stands twice',
                    f"it is already set in line {line}; keep one of the two",
                )
                continue
            seen[key.value] = key
            converted = self._convert(child)
            size += converted.size
            depth = max(depth, 1 + converted.depth)
            if converted.value is not None:
                values[key.value] = converted.value
        return _Converted(values, size, depth)

    def _list(self, node: yaml.Node) -> _Converted:
        converted = [self._convert(child) for child in node.value]
        return _Converted(
            [child.value for child in converted],
            1 + sum(child.size for child in converted),
            1 + max((child.depth for child in converted), default=0),
        )

    def _check_expansion(self, node: yaml.Node, converted: _Converted) -> None:
        if self._expansion_reported:
            return
        if converted.size > MAX_EXPANSION:
            self._expansion_reported = True
            self._note(node, f"aliases expand to more than {MAX_EXPANSION:,} values")
        elif converted.depth > MAX_DEPTH:
            self._expansion_reported = True
            self._note(node, f"aliases expand to more than {MAX_DEPTH} levels")

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


def _merge(node: yaml.Node | None, seen: set[int]) -> None:
    """Resolve merge keys (``<<: *base``) in place, what is merged before what merges it.

    What a mapping says itself comes before what it merges, the first merged one before the next.
    Merged keys alone are deduplicated, so that a key written twice stays an error.
    """
    if not isinstance(node, yaml.CollectionNode) or id(node) in seen:
        return
    seen.add(id(node))
    if not isinstance(node, yaml.MappingNode):
        for child in node.value:
            _merge(child, seen)
        return
    for key, value in node.value:
        _merge(key, seen)
        _merge(value, seen)
    own = [pair for pair in node.value if not _is_merge(pair[0])]
    if len(own) == len(node.value):
        return
    named = {key.value for key, _ in own if isinstance(key, yaml.ScalarNode)}
    merged: dict[str, tuple[yaml.Node, yaml.Node]] = {}
    for key, value in node.value:
        for source in _merge_sources(value) if _is_merge(key) else []:
            for pair in source.value:
                name = pair[0]
                if isinstance(name, yaml.ScalarNode) and not _is_merge(name):
                    merged.setdefault(name.value, pair)
    node.value = [pair for name, pair in merged.items() if name not in named] + own


def _is_merge(key: yaml.Node) -> bool:
    return bool(key.tag == _STANDARD_TAG + "merge")


def _merge_sources(value: yaml.Node) -> list[yaml.MappingNode]:
    sources = value.value if isinstance(value, yaml.SequenceNode) else [value]
    for source in sources:
        if not isinstance(source, yaml.MappingNode):
            problem = "<< takes a mapping or a list of mappings"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=source.start_mark)
    return list(sources)


def _nested_too_deeply(text: str) -> bool:
    """Whether values nest beyond MAX_DEPTH; the parser is asked only where a scan suspects it.

    A column of indentation opens at most two levels (a mapping and a list in it), an indicator
    or a bracket one.
    """
    brackets = _highest(1 if c in "[{" else -1 for c in re.findall(r"[\[\]{}]", text))
    indicators = max((len(run) for run in re.findall(r"(?:[-?:] +)+", text)), default=0) // 2
    columns = max(
        (len(run) for run in re.findall(r"(?:^|[\r\x85\u2028\u2029]) +", text, re.MULTILINE)),
        default=0,
    )
    if brackets + indicators + 2 * (columns + 1) <= MAX_DEPTH:
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
    if "another document" in problem:
        return "one scene a file: remove the line ---"
    return "check brackets, quotes and indentation"


def _similar_file(path: Path) -> str:
    import difflib

    try:
        names = [entry.name for entry in path.parent.iterdir() if entry.is_file()]
    except (FileNotFoundError, NotADirectoryError):
        return f"there is no folder {path.parent.name}/ there"
    except (OSError, ValueError):  # a name too long, say
        names = []
    near = difflib.get_close_matches(path.name, names, n=1)
    return f'did you mean "{near[0]}"?' if near else "paths are relative to the scene file"
