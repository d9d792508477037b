"""A file that was read, and where in it each of its values stands."""

from __future__ import annotations

import difflib
import json
import re
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from geotween.scene.errors import Fault, SceneError
from geotween.scene.nodes import MAX_DEPTH, child_of, compose, nested_too_deeply

Location = tuple[str | int, ...]

# A colour without quotes is a comment to YAML.
BARE_HASH = re.compile(r"[:,\[{]\s*#[0-9A-Fa-f]{3}")
QUOTE_COLOURS = '# begins a comment: a colour needs quotes, "#c1440e"'


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
        if nested_too_deeply(self.text):
            raise SceneError([self.fault_at(1, 1, f"nested more than {MAX_DEPTH} levels deep")])
        try:
            return compose(self.text)
        except yaml.MarkedYAMLError as error:
            raise SceneError([self._broken(error)]) from None
        except yaml.reader.ReaderError as error:
            code = error.character if isinstance(error.character, int) else ord(error.character)
            line, column = self.place_of(self.text.index(chr(code)))
            message = f"the character U+{code:04X} may not stand in YAML"
            raise SceneError([self.fault_at(line, column, message, "remove it")]) from None

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
            found = child_of(node, step)
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
        near = "\n".join(self.lines[max(0, line - 3) : line])
        hint = QUOTE_COLOURS if BARE_HASH.search(near) else _hint(problem)
        return self.fault_at(line, column, f"this is not YAML: {problem}{context}", hint)

    def place_of(self, position: int) -> tuple[int, int]:
        """Line and column, from 1, of a position in the text."""
        lines = f"{self.text[:position]}|".splitlines()
        return len(lines), len(lines[-1])


def read_text(
    path: Path, name: str, *, named_by: Fault | None = None, encoding: str | None = None
) -> str:
    """The text of a file, in UTF-8 unless an encoding is named.

    Raises
    ------
    SceneError
        At the place that names the file (``named_by``) where it cannot be opened; in the file
        itself where it is not in its encoding.
    """
    try:
        raw = path.read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        reason = str(getattr(error, "strerror", None) or error).lower()
        text = f"cannot read {name}: {reason}"
        if named_by is None:
            raise SceneError([Fault(name, 1, 1, text)]) from None
        hint = _similar_file(path)
        raise SceneError([replace(named_by, message=text, hint=hint)]) from None
    try:
        return raw.decode(encoding or "utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        raise SceneError([_undecodable(error, name, named_by, encoding)]) from None
    except (LookupError, UnicodeError):
        fault = named_by or Fault(name, 1, 1, "")
        hint = "such as utf-8, latin-1, cp1252 or utf-16"
        raise SceneError([replace(fault, message=f"no encoding {encoding}", hint=hint)]) from None


def _undecodable(
    error: UnicodeDecodeError, name: str, named_by: Fault | None, encoding: str | None
) -> Fault:
    before = error.object[: error.start].decode(errors="replace")
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    message = f"the byte 0x{error.object[error.start]:02X} is not {encoding or 'UTF-8'}"
    hint = "save the file as UTF-8"
    if named_by is not None:
        hint += ", or name its encoding: {file: …, encoding: latin-1}"
    return Fault(name, line, column, message, hint)


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
        hint = "expected GeoJSON or TopoJSON: the suffix says which format a file has"
        if not document.text.strip():
            hint = "the file is empty"
        elif error.pos >= len(document.text.rstrip()):
            hint = "the file ends too early"
        place = document.place_of(error.pos)
        raise SceneError([document.fault_at(*place, f"not JSON: {error.msg}", hint)]) from None
    except ValueError:  # Python reads no whole number of more than 4,300 digits
        raise SceneError([document.fault_at(1, 1, "a number has too many digits")]) from None
    except RecursionError:
        raise SceneError([document.fault_at(1, 1, "nested too deeply")]) from None


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
    try:
        names = [entry.name for entry in path.parent.iterdir() if entry.is_file()]
    except (FileNotFoundError, NotADirectoryError):
        return f"there is no folder {path.parent.name}/ there"
    except (OSError, ValueError):  # a name too long, say
        names = []
    near = difflib.get_close_matches(path.name, names, n=1)
    return f'did you mean "{near[0]}"?' if near else "paths are relative to the scene file"
