"""A YAML text as plain values: every scalar stays as it was written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geotween.scene.document import Document, read_json, read_text
from geotween.scene.errors import Fault, SceneError
from geotween.scene.nodes import MAX_DEPTH
from geotween.scene.plain import read_yaml


def document(text: str) -> Document:
    return Document("s.yaml", Path("s.yaml"), text)


def values(text: str) -> Any:
    value, found = read_yaml(document(text))
    if found:
        raise SceneError(sorted(found))
    return value


def faults(text: str) -> tuple[Fault, ...]:
    with pytest.raises(SceneError) as caught:
        values(text)
    return caught.value.faults


def told(text: str) -> list[tuple[int, int, str]]:
    return [(fault.line, fault.column, fault.message) for fault in faults(text)]


@pytest.mark.parametrize(
    "scalar", ["no", "yes", "on", "true", "12:30", "2024-01-05", "2024-13-45", "017", "0x1F",
               "1_000", "1e3", ".inf", ".nan", "=", "5"],
)  # fmt: skip
@pytest.mark.parametrize("quote", ["", "'", '"'])
def test_scalar_stays_the_text_that_was_written(scalar: str, quote: str) -> None:
    assert values(f"a: {quote}{scalar}{quote}") == {"a": scalar}


@pytest.mark.parametrize("nothing", ["~", "null", "", "# a comment"])
def test_key_without_a_value_is_absent(nothing: str) -> None:
    assert values(f"a: {nothing}\nb: 1") == {"b": "1"}


@pytest.mark.parametrize("quoted", ['"~"', "'null'", '"null"'])
def test_quoted_null_is_a_text(quoted: str) -> None:
    assert values(f"a: {quoted}") == {"a": quoted[1:-1]}


def test_quoted_nothing_is_the_empty_text() -> None:
    assert values('a: ""') == {"a": ""}


def test_block_text_keeps_its_lines_and_folded_text_does_not() -> None:
    assert values("a: |\n  x\n  y\nb: >-\n  x\n  y\n") == {"a": "x\ny\n", "b": "x y"}


def test_null_in_a_list_keeps_its_place() -> None:
    assert values("[a, ~, b]") == ["a", None, "b"]


def test_key_is_a_text_whatever_it_looks_like() -> None:
    assert values("1: a\nno: b\n~: c\n2024-01-05: d") == {
        "1": "a", "no": "b", "~": "c", "2024-01-05": "d",
    }  # fmt: skip


def test_standard_tags_change_nothing() -> None:
    assert values("a: !!str 5\nb: !!int 5\nc: !!map {d: 1}") == {
        "a": "5",
        "b": "5",
        "c": {"d": "1"},
    }


@pytest.mark.parametrize("text", ["", "\n\n", "# only a comment\n", "---\n", "--- ~\n...\n"])
def test_empty_document_is_nothing(text: str) -> None:
    assert values(text) is None


def test_json_is_yaml() -> None:
    assert values('{"a": [1, true, null]}') == {"a": ["1", "true", None]}


# Duplicate keys, aliases, merge keys


def test_key_that_stands_twice_is_refused_at_its_second_place() -> None:
    (fault,) = faults("a: 1\nb: 2\na: 3\n")
    assert (fault.line, fault.column) == (3, 1)
    assert fault.message == 'the key "a" stands twice'
    assert fault.hint == "it is already set in line 1; keep one of the two"


def test_same_key_quoted_and_bare_is_a_duplicate() -> None:
    assert told("{a: 1, 'a': 2}") == [(1, 8, 'the key "a" stands twice')]


def test_alias_is_the_value_it_names() -> None:
    assert values("a: &x [1, 2]\nb: *x") == {"a": ["1", "2"], "b": ["1", "2"]}


def test_merged_key_gives_way_to_an_own_one() -> None:
    merged = values("base: &b {x: 1, y: 2}\nown: {<<: *b, y: 3}")
    assert merged["own"] == {"x": "1", "y": "3"}
    assert merged["base"] == {"x": "1", "y": "2"}


def test_first_of_several_merged_mappings_wins() -> None:
    merged = values("a: &a {x: 1}\nb: &b {x: 2, y: 2}\nown: {<<: [*a, *b]}")
    assert merged["own"] == {"x": "1", "y": "2"}


def test_merge_of_a_merge_overrides_without_a_duplicate() -> None:
    merged = values("a: &a {x: 1}\nb: &b {<<: *a, x: 2}\nc: {<<: *b}")
    assert merged == {"a": {"x": "1"}, "b": {"x": "2"}, "c": {"x": "2"}}


def test_merge_of_an_inline_mapping_that_merges() -> None:
    assert values("a: &a {x: 1}\nb: {<<: {<<: *a, y: 2}}")["b"] == {"x": "1", "y": "2"}


def test_key_twice_beside_a_merge_is_still_a_duplicate() -> None:
    assert told("a: &a {x: 1}\nb: {<<: *a, y: 2, y: 3}") == [(2, 19, 'the key "y" stands twice')]


def test_quoted_merge_key_is_an_ordinary_key() -> None:
    assert values('a: {"<<": b}') == {"a": {"<<": "b"}}


@pytest.mark.parametrize("merged", ["5", "[1]", "[[a, b]]"])
def test_merge_takes_mappings_only(merged: str) -> None:
    (fault,) = faults(f"a: {{<<: {merged}}}")
    assert "<< takes a mapping or a list of mappings" in fault.message
    assert (fault.line, fault.column) == (1, 9 if merged == "5" else 10)


def test_long_chain_of_merges_is_read() -> None:
    links = (f"a{i}: &a{i} {{<<: *a{i - 1}}}" for i in range(1, 3000))
    merged = values("\n".join(["a0: &a0 {x: 1}", *links]))
    assert merged["a2999"] == {"x": "1"}


def test_merge_bomb_does_not_expand() -> None:
    layers = (f"a{i}: &a{i} {{<<: [{', '.join([f'*a{i - 1}'] * 9)}]}}" for i in range(1, 30))
    merged = values("\n".join(["a0: &a0 {x: 1}", *layers]))
    assert merged["a29"] == {"x": "1"}


def test_alias_bomb_is_refused() -> None:
    layers = (f"x{i}: &x{i} [{', '.join([f'*x{i - 1}'] * 9)}]" for i in range(1, 30))
    assert told("\n".join(["x0: &x0 [1]", *layers])) == [
        (8, 5, "aliases expand to more than 5,000,000 values")
    ]


def test_tower_of_aliases_is_refused() -> None:
    layers = (f"x{i}: &x{i} [*x{i - 1}]" for i in range(1, 2000))
    assert told("\n".join(["x0: &x0 [1]", *layers])) == [
        (201, 7, "aliases expand to more than 200 levels")
    ]


@pytest.mark.parametrize("text", ["a: &x [*x]", "a: &x {b: *x}", "a: &x {<<: {b: *x}}"])
def test_alias_inside_what_it_names_is_refused(text: str) -> None:
    assert told(text) == [(1, 4, "an alias may not stand inside what it names")]


def test_alias_of_nothing_is_refused() -> None:
    (fault,) = faults("a: *x")
    assert (fault.line, fault.column) == (1, 4)
    assert "undefined alias" in fault.message


# Tags and keys that have no meaning


@pytest.mark.parametrize(
    ("text", "column", "tag"),
    [
        ("a: !foo b", 4, "!foo"),
        ("a: !!binary b", 4, "!!binary"),
        ("a: !!python/object:os.system {b: c}", 4, "!!python/object:os.system"),
        ("a: !!set {b, c}", 4, "!!set"),
        ("!foo a: b", 1, "!foo"),
    ],
)
def test_foreign_tag_is_refused(text: str, column: int, tag: str) -> None:
    assert told(text) == [(1, column, f"the tag {tag} has no meaning in a scene")]


@pytest.mark.parametrize("key", ["[1, 2]", "{b: 1}"])
def test_key_that_is_not_a_text_is_refused(key: str) -> None:
    assert told(f"a: 1\n? {key}\n: 2") == [(2, 3, "a key must be a text")]


def test_merged_key_that_is_not_a_text_is_refused_where_it_stands() -> None:
    assert told("a: &x {? [1] : 2}\nb: {<<: *x}") == [(1, 10, "a key must be a text")]


def test_all_faults_come_at_once_and_sorted() -> None:
    assert told("b: !foo 1\nc: {x: 1, x: 2}\n? [1]\n: 2\n") == [
        (1, 4, "the tag !foo has no meaning in a scene"),
        (2, 11, 'the key "x" stands twice'),
        (3, 3, "a key must be a text"),
    ]


# Depth


def brackets(depth: int) -> str:
    return "[" * depth + "]" * depth


def indented(depth: int) -> str:
    return "\n".join(" " * level + "a:" for level in range(depth - 1)) + " {}"


def dashes(depth: int) -> str:
    return "- " * (depth - 1) + "[]"


def dashes_then_brackets(depth: int) -> str:
    return "- " * (depth // 2) + brackets(depth - depth // 2)


NESTINGS = [brackets, indented, dashes, dashes_then_brackets]


@pytest.mark.parametrize("nested", NESTINGS)
def test_nesting_up_to_the_limit_is_read(nested: Any) -> None:
    value, depth = values(nested(MAX_DEPTH)), 0
    while isinstance(value, dict | list):
        inner = value.values() if isinstance(value, dict) else value
        value, depth = next(iter(inner), None), depth + 1
    assert depth == MAX_DEPTH


@pytest.mark.parametrize("nested", NESTINGS)
@pytest.mark.parametrize("depth", [MAX_DEPTH + 1, 900])
def test_deeper_nesting_is_refused(nested: Any, depth: int) -> None:
    assert told(nested(depth)) == [(1, 1, "nested more than 200 levels deep")]


def test_many_thousand_brackets_are_refused() -> None:
    assert told("[" * 100_000) == [(1, 1, "nested more than 200 levels deep")]


def test_brackets_in_a_text_are_not_nesting() -> None:
    assert values(f'a: "{"[" * 300}"') == {"a": "[" * 300}


# Texts that are not YAML


@pytest.mark.parametrize(
    ("text", "place", "message", "hint"),
    [
        ("a: b: c", (1, 5), "mapping values are not allowed", "a text with a colon in it"),
        ("a: 1\nb: [1, 2\nc: 3\n", (3, 2), "did not find expected ',' or ']'", "not closed"),
        ("a:\n\tb: 1\n", (2, 1), "cannot start any token", "indent with spaces, not tabs"),
        ("a: @b", (1, 4), "cannot start any token", "needs quotes"),
        ('a: 1\nb: "c\n', (2, 6), "unexpected end of stream", "quotes"),
        ("a: 1\n---\nb: 2\n", (2, 1), "found another document", "remove the line ---"),
        ("a: 1\n b: 2\n", (2, 3), "mapping values are not allowed", "quotes"),
    ],
)
def test_broken_yaml(text: str, place: tuple[int, int], message: str, hint: str) -> None:
    (fault,) = faults(text)
    assert (fault.line, fault.column) == place
    assert fault.message.startswith("this is not YAML: ")
    assert message in fault.message
    assert hint in fault.hint


def test_control_character_is_shown_at_its_place() -> None:
    (fault,) = faults("title: Köln\nsub: äöü\x01x\n")
    assert (fault.line, fault.column) == (2, 9)
    assert fault.message == "the character U+0001 may not stand in YAML"
    assert fault.hint == "remove it"


@given(st.text(max_size=30))
def test_any_quoted_text_comes_out_as_it_went_in(text: str) -> None:
    escaped = "".join(f"\\U{ord(c):08X}" for c in text)
    assert values(f'a: "{escaped}"') == {"a": text}


@given(st.text(st.sampled_from("ab:-?[]{}&*!|>'\"%@#,~ \n\t\r\x00é\u2028"), max_size=40))
def test_any_text_is_read_or_refused_at_a_place(text: str) -> None:
    places = []
    try:
        values(text)
    except SceneError as error:
        places = [(fault.line, fault.column) for fault in error.faults] or [(0, 0)]
    assert all(line >= 1 and column >= 1 for line, column in places)


# Files


def test_byte_order_mark_and_windows_line_ends(tmp_path: Path) -> None:
    path = tmp_path / "s.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1\r\nb:\r\n  c: 2\r\n")
    assert values(read_text(path, "s.yaml")) == {"a": "1", "b": {"c": "2"}}


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_byte_that_is_not_utf8_is_shown_at_its_place(tmp_path: Path, mark: bytes) -> None:
    path = tmp_path / "s.yaml"
    path.write_bytes(mark + "a: 1\nü: ".encode() + b"\xff\n")
    with pytest.raises(SceneError) as caught:
        read_text(path, "s.yaml")
    assert str(caught.value) == (
        "s.yaml:2:4: the byte 0xFF is not UTF-8\n       = save the file as UTF-8\n\n1 error"
    )


def test_utf16_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "s.yaml"
    path.write_text("a: 1", encoding="utf-16")
    with pytest.raises(SceneError, match=r"s\.yaml:1:1: the byte 0xFF is not UTF-8"):
        read_text(path, "s.yaml")


def test_file_that_is_missing(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"s\.yaml:1:1: cannot read s\.yaml: no such file"):
        read_text(tmp_path / "s.yaml", "s.yaml")


# JSON

GEOJSON = "expected GeoJSON or TopoJSON: the suffix says which format a file has"


@pytest.mark.parametrize(
    ("text", "place", "hint"),
    [
        ("", (1, 1), "the file is empty"),
        (" \n", (2, 1), "the file is empty"),
        ('{"a": [1,\n  2', (2, 4), "the file ends too early"),
        ("<!DOCTYPE html>", (1, 1), GEOJSON),
        ('{"a": "\u2028",\n b}', (3, 2), GEOJSON),  # that separator ends a line
    ],
)
def test_text_that_is_not_json(text: str, place: tuple[int, int], hint: str) -> None:
    with pytest.raises(SceneError) as caught:
        read_json(document(text))
    (fault,) = caught.value.faults
    assert (fault.line, fault.column) == place
    assert fault.message.startswith("not JSON: ")
    assert fault.hint == hint


@pytest.mark.parametrize(
    ("text", "message"),
    [("[" * 100_000, "nested too deeply"), ("1" * 5000, "a number has too many digits")],
    ids=["brackets", "digits"],
)
def test_json_beyond_what_python_reads(text: str, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        read_json(document(text))
