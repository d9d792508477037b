"""Files are written whole, under names that links can carry, or not at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner

import geotween
from geotween.cli import main
from geotween.export.build import render_scene

SQUARE = "[[0, 0], [4, 0], [4, 4]]"
SCENE = f"title: t\nsteps:\n  - polygons: []\n  - polygons: [{SQUARE}]\n  - polygons: []\n"


def test_a_folder_in_the_place_of_a_file_leaves_all_as_it_was(
    write_scene: Callable[..., Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    (out / "index.html").mkdir(parents=True)
    result = CliRunner().invoke(main, ["build", str(write_scene(SCENE)), "-o", str(out)])
    assert result.exit_code == 2
    assert "a folder of that name is there" in result.stderr
    assert [entry.name for entry in out.iterdir()] == ["index.html"]


@pytest.mark.parametrize(
    ("name", "link"),
    [("50% #1? a", "50%25%20%231%3F%20a"), ("javascript:alert(1)", "javascript%3Aalert%281%29")],
)
def test_links_are_quoted(write_scene: Callable[..., Path], name: str, link: str) -> None:
    scene = geotween.load(write_scene(SCENE, f"{name}.yaml"))
    rendered = render_scene(scene)
    assert (rendered.card.href, rendered.card.svg_href) == (f"{link}.html", f"{link}.svg")
    assert f'href="{link}.svg"' in rendered.files[f"{name}.html"].decode()


def test_the_still_shows_a_step_that_has_polygons(write_scene: Callable[..., Path]) -> None:
    text = SCENE + f"  - polygons: []\n  - polygons: [{SQUARE}]\n"
    for steps in (text, SCENE):
        still = render_scene(geotween.load(write_scene(steps))).card.still
        assert 'class="region"' in still


def test_polygons_too_small_to_be_drawn_are_told(write_scene: Callable[..., Path]) -> None:
    layer = "[[-1e9, -1e9], [1e9, -1e9], [1e9, 1e9]]"
    scene = geotween.load(
        write_scene(SCENE.replace("steps:", f"map: {{layers: [{{polygons: {layer}}}]}}\nsteps:"))
    )
    found = [p for p in render_scene(scene).problems if p.kind == "too small"]
    assert [(p.severity, p.steps, p.measure) for p in found] == [("warning", ("2",), 1)]


def test_without_smil_the_svg_shows_the_first_step(write_scene: Callable[..., Path]) -> None:
    text = f"title: t\nsteps:\n  - polygons: [{SQUARE}]\n  - polygons: []\n"
    rendered = render_scene(geotween.load(write_scene(text)))
    svg = rendered.files["scene.svg"].decode()
    first, *others = [part.split(">")[0] for part in svg.split("<path")[1:]]
    assert "visibility" not in first
    assert all('visibility="hidden"' in other for other in others)
