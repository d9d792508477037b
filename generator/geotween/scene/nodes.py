"""The node tree of a YAML text: composed, merge keys resolved, and guarded against its depth."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import yaml

MAX_DEPTH = 200  # levels; each takes three of Python's 1,000 calls on the stack
STANDARD_TAG = "tag:yaml.org,2002:"
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def compose(text: str) -> yaml.Node | None:
    """The root node of a text of one document, with what is merged (``<<``) in place.

    Raises
    ------
    yaml.YAMLError
        Where the text is not YAML.
    """
    loader = _Loader(text)
    try:
        root: yaml.Node | None = loader.get_single_node()
    finally:
        loader.dispose()
    _merge(root, set())
    return root


def child_of(node: yaml.Node | None, step: str | int) -> tuple[yaml.Node, yaml.Node] | None:
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
    return bool(key.tag == STANDARD_TAG + "merge")


def _merge_sources(value: yaml.Node) -> list[yaml.MappingNode]:
    sources = value.value if isinstance(value, yaml.SequenceNode) else [value]
    for source in sources:
        if not isinstance(source, yaml.MappingNode):
            problem = "<< takes a mapping or a list of mappings"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=source.start_mark)
    return list(sources)


def nested_too_deeply(text: str) -> bool:
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
