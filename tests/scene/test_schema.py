"""The JSON Schema for editors, and the names of techniques in it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, get_args

import pytest
import yaml
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from geotween.cli import main
from geotween.motion import correspond, divide, match, paths, techniques
from geotween.motion.front.changes import ANNEXATIONS
from geotween.scene.model import Motion
from geotween.scene.read import scene_schema

SCENES = Path(__file__).parents[2] / "scenes"
EXAMPLES = sorted(SCENES.glob("*.yaml"))


class EditorLoader(yaml.SafeLoader):
    """Types numbers, booleans and nulls as an editor does, and leaves dates texts."""


EditorLoader.yaml_implicit_resolvers = {
    first: [(tag, regexp) for tag, regexp in resolvers if not tag.endswith(":timestamp")]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}


def errors(text: str) -> list[str]:
    values = yaml.load(text, Loader=EditorLoader)
    validator = Draft202012Validator(scene_schema())
    return [error.json_path for error in validator.iter_errors(values)]


def test_schema_is_a_valid_one_of_its_draft() -> None:
    schema = scene_schema()
    assert schema["$schema"] == Draft202012Validator.META_SCHEMA["$id"]
    Draft202012Validator.check_schema(schema)


def test_there_are_example_scenes() -> None:
    assert EXAMPLES


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_scene_fits_the_schema(path: Path) -> None:
    assert errors(path.read_text(encoding="utf-8")) == []


def test_what_the_reader_types_itself_fits_the_schema() -> None:
    text = """
        title: 1984
        style: {class: {no: {fill: red}}, fill: none}
        timing: {loop: yes, transition: [1, 2]}
        steps:
          - {time: 2024-01-05, label: 5, polygons: "POLYGON ((0 0, 9 0, 9 9, 0 0))"}
          - {time: 2024-01-06, polygons: [[[0, 0], [4, 0], [4, 4]], {key: 3, polygon: []}]}
          - {time: 2024-01-07, polygons: {type: FeatureCollection, features: []}}
    """
    assert errors(text) == []


@pytest.mark.parametrize(
    ("line", "place"),
    [
        ("titel: t", "$"),
        ("map: {width: wide}", "$.map.width"),
        ("map: {fit: eahc}", "$.map.fit"),
        ("style: {opacity: 2}", "$.style.opacity"),
        ("motion: {method: papr}", "$.motion.method"),
        ("timing: {transition: 0}", "$.timing.transition"),
    ],
)
def test_editor_is_told_of_a_wrong_value(line: str, place: str) -> None:
    assert errors(f"title: t\n{line}\nsteps: [{{polygons: []}}, {{polygons: []}}]") == [place]


def test_editor_is_told_of_a_missing_step() -> None:
    assert errors("title: t\nsteps: [{polygons: []}]") == ["$.steps"]


def test_schema_beside_the_scenes_is_the_one_that_is_printed() -> None:
    printed = CliRunner().invoke(main, ["schema"], catch_exceptions=False)
    assert printed.exit_code == 0
    assert json.loads(printed.stdout) == scene_schema()
    kept = (SCENES / "scene.schema.json").read_text(encoding="utf-8")
    assert kept == printed.stdout, "write it anew with: make schema"


@pytest.mark.parametrize(
    ("field", "registry"),
    [
        ("method", techniques.METHODS),
        ("correspondence", correspond.TECHNIQUES),
        ("division", divide.TECHNIQUES),
        ("matching", match.TECHNIQUES),
        ("path", paths.TECHNIQUES),
        ("annexation", ANNEXATIONS),
    ],
)
def test_scene_may_name_just_the_techniques_that_there_are(field: str, registry: Any) -> None:
    annotation = Motion.model_fields[field].annotation
    literals = [part for part in (annotation, *get_args(annotation)) if get_args(part)]
    named = {name for name in get_args(literals[-1]) if isinstance(name, str)}
    assert named == set(registry)
