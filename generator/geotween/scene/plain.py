"""A YAML document as plain values: dicts, lists, texts and None.

Every scalar stays the text that was written: ``no``, ``12:30``, ``017`` and ``2024-01-05`` arrive
as such, and the scene model's types decide what they are.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import yaml

from geotween.scene.document import BARE_HASH, QUOTE_COLOURS, Document
from geotween.scene.errors import Fault, SceneError
from geotween.scene.nodes import MAX_DEPTH, STANDARD_TAG

MAX_EXPANSION = 5_000_000  # values after aliases are expanded; stops an alias bomb
_NULLS = frozenset({"", "~", "null"})
_PLAIN_TAGS = frozenset(
    STANDARD_TAG + name
    for name in ["null", "bool", "int", "float", "timestamp", "str", "seq", "map", "merge", "value"]
)


def read_yaml(document: Document) -> tuple[Any, list[Fault]]:
    """The document as dicts, lists, texts and None, and what is wrong with it.

    Keys without a value are left out. Duplicate keys, keys that are not text and foreign tags are
    faults that leave something to go on with.

    Raises
    ------
    SceneError
        Where there is nothing to go on with: broken YAML, aliases in a loop or beyond all bounds.
    """
    reader = _Reader(document)
    value = reader.value(document.root)
    if reader.endless:
        raise SceneError(sorted(reader.faults))
    return value, reader.faults


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
        self.endless = False
        self._done: dict[int, _Converted] = {}
        self._open: set[int] = set()

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
            self.endless = True
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
            elif BARE_HASH.match(self._after(key)):
                self._note(key, f'"{key.value}" has no value', QUOTE_COLOURS)
        return _Converted(values, size, depth)

    def _list(self, node: yaml.Node) -> _Converted:
        converted = [self._convert(child) for child in node.value]
        return _Converted(
            [child.value for child in converted],
            1 + sum(child.size for child in converted),
            1 + max((child.depth for child in converted), default=0),
        )

    def _check_expansion(self, node: yaml.Node, converted: _Converted) -> None:
        if self.endless:
            return
        if converted.size > MAX_EXPANSION:
            self.endless = True
            self._note(node, f"aliases expand to more than {MAX_EXPANSION:,} values")
        elif converted.depth > MAX_DEPTH:
            self.endless = True
            self._note(node, f"aliases expand to more than {MAX_DEPTH} levels")

    def _check_tag(self, node: yaml.Node) -> None:
        if node.tag not in _PLAIN_TAGS:
            tag = node.tag.replace(STANDARD_TAG, "!!")
            self._note(node, f"the tag {tag} has no meaning in a scene", "remove it")

    def _after(self, key: yaml.Node) -> str:
        """The rest of a key's line, from the colon on."""
        line: str = self.document.lines[key.end_mark.line]
        return line[key.end_mark.column :]

    def _note(self, node: yaml.Node, message: str, hint: str = "") -> None:
        mark = node.start_mark
        self.faults.append(self.document.fault_at(mark.line + 1, mark.column + 1, message, hint))
