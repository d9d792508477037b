"""Words: two languages, a scene's own, amounts and times, and templates that can only say."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from jinja2 import meta

from geotween.data.load import load
from geotween.scene.errors import SceneError
from geotween.story import templates
from geotween.story.captions import alternative, captions, told
from geotween.story.templates import MESSAGES, WordsFile
from geotween.story.words import LANGUAGES, Words, words_of_scene
from tests.conftest import WriteScene

FOLDER = Path(templates.__file__).parent / "languages"
FIRE = """
title: Fire
{head}
map: {{unit: km}}
steps:
  - time: 2020-09-09
    polygons:
      - [[0, 0], [20, 0], [20, 20], [0, 20]]
      - [[21, 0], [22, 0], [22, 1], [21, 1]]
      - [[21, 5], [22, 5], [22, 6], [21, 6]]
  - time: 2020-09-10
    polygons: [[[0, 0], [25, 0], [25, 25], [0, 25]]]
"""


def words(lang: str = "en") -> Words:
    values = yaml.safe_load((FOLDER / f"{lang}.yaml").read_text(encoding="utf-8"))
    return Words(WordsFile.model_validate(values), lang)


def scene_words(write_scene: WriteScene, own: str, head: str = "") -> tuple[str, ...]:
    path = write_scene(FIRE.format(head=f"story: {{words: own.yaml}}\n{head}"))
    (path.parent / "own.yaml").write_text(own, encoding="utf-8")
    return told(load(path))


def refused(write_scene: WriteScene, own: str) -> str:
    with pytest.raises(SceneError) as caught:
        scene_words(write_scene, own)
    return str(caught.value)


# Languages


@pytest.mark.parametrize("lang", LANGUAGES)
def test_a_language_has_every_message_and_uses_all_that_it_is_given(lang: str) -> None:
    says = words(lang).file.says
    assert set(says) == set(MESSAGES)
    environment = templates._environment()
    optional = {"usual", "area", "class", "distance"}
    for name, forms in says.items():
        used = {v for t in forms.values() for v in _variables(environment, t)}
        assert used <= MESSAGES[name]
        assert MESSAGES[name] - used <= optional, name


def _variables(environment: object, text: str) -> set[str]:
    return meta.find_undeclared_variables(environment.parse(text))  # type: ignore[attr-defined]


def test_a_fire_that_swallows_two_spots_in_english(write_scene: WriteScene) -> None:
    path = write_scene(FIRE.format(head="story: {noun: fire, nouns: fires}"))
    assert told(load(path)) == (
        "9 September 2020: three fires, 40,200 ha in all.",
        "Between 9 and 10 September the fire grew by 56% to 62,500 ha and merged with two other "
        "fires.",
    )


def test_a_fire_that_swallows_two_spots_in_german(write_scene: WriteScene) -> None:
    path = write_scene(FIRE.format(head="lang: de"))
    assert told(load(path)) == (
        "9. September 2020: drei Flächen, zusammen 40.200 ha.",
        "9. bis 10. September: Die Fläche wuchs um 56\N{NO-BREAK SPACE}% auf 62.500 ha und nahm "
        "zwei weitere Flächen auf.",
    )
    path = write_scene(FIRE.format(head="lang: de\nstory: {noun: Feuer, nouns: Feuer}"))
    assert "September: Feuer wuchs um" in told(load(path))[1]


def test_numbers_follow_the_region(write_scene: WriteScene) -> None:
    scene = load(write_scene(FIRE.format(head="lang: de-CH")))
    assert "62’500 ha" in told(scene)[1]
    assert words_of_scene(scene).lang == "de-CH"


@pytest.mark.parametrize("lang", ["fr", "zz", "xx-private"])
def test_an_unknown_language_is_told_in_english_and_says_so(
    write_scene: WriteScene, lang: str
) -> None:
    scene = load(write_scene(FIRE.format(head=f"lang: {lang}")))
    assert words_of_scene(scene).lang == "en"
    assert told(scene)[1].startswith("Between 9 and 10 September the area grew")


# Amounts and times


@pytest.mark.parametrize(
    ("area", "english", "german"),
    [
        (0.5, "0.5 m²", "0,5 m²"),
        (9_994, "9,990 m²", "9.990 m²"),
        (9_996, "1 ha", "1 Hektar"),
        (6.2e8, "62,000 ha", "62.000 ha"),
        (9.996e8, "1,000 km²", "1.000 km²"),
        (7.81e12, "7,810,000 km²", "7.810.000 km²"),
    ],
)
def test_areas_have_three_figures_and_a_fitting_unit(
    area: float, english: str, german: str
) -> None:
    assert (words("en").area(area), words("de").area(area)) == (english, german)


@pytest.mark.parametrize(("length", "text"), [(41.6, "42 m"), (996, "1 km"), (125_900, "130 km")])
def test_lengths_have_two_figures(length: float, text: str) -> None:
    assert words().length(length) == text


@pytest.mark.parametrize(
    ("bearing", "compass", "page"),
    [
        (0, "north", "up"),
        (22.4, "north", "up"),
        (22.6, "northeast", "up and to the right"),
        (270, "west", "to the left"),
        (359, "north", "up"),
    ],
)
def test_directions_are_eight(bearing: float, compass: str, page: str) -> None:
    assert words().direction(bearing, compass=True) == compass
    assert words().direction(bearing, compass=False) == page


@pytest.mark.parametrize(
    ("times", "period"),
    [
        (("2020-09-09", "2020-09-10"), "Between 9 and 10 September"),
        (("2020-08-31", "2020-09-01"), "Between 31 August and 1 September"),
        (("2020-12-31", "2021-01-01"), "Between 31 December 2020 and 1 January 2021"),
        (("2012-10-24T03:00", "2012-10-24T09:00"), "Between 03:00 and 09:00 on 24 October"),
        (("2012-10-24T21:00", "2012-10-25T03:00"),
         "Between 21:00 on 24 October and 03:00 on 25 October"),
        (("1960", "1976"), "From 1960 to 1976,"),
    ],
)  # fmt: skip
def test_periods(write_scene: WriteScene, times: tuple[str, str], period: str) -> None:
    steps = "".join(
        f"  - {{time: {t}, polygons: [[[0, 0], [4, 0], [4, {n}], [0, {n}]]]}}\n"
        for n, t in enumerate(times, start=4)
    )
    scene = load(write_scene(f"title: t\nsteps:\n{steps}"))
    assert told(scene)[1] == f"{period} the area grew by 25%."


def test_the_year_is_told_where_the_scene_has_several(write_scene: WriteScene) -> None:
    square = "[[[0, 0], [4, 0], [4, 4], [0, 4]]]"
    times = ["2020-09-09", "2020-09-10", "2021-01-01"]
    steps = "".join(f"  - {{time: {t}, polygons: {square}}}\n" for t in times)
    scene = load(write_scene(f"title: t\nsteps:\n{steps}"))
    assert told(scene)[1] == "Between 9 and 10 September 2020 nothing changed."


def test_labels_take_the_place_of_times(write_scene: WriteScene) -> None:
    text = FIRE.format(head="").replace(
        "- time: 2020-09-09", "- label: Day 1\n    time: 2020-09-09"
    )
    assert told(load(write_scene(text)))[1].startswith("From Day 1 to 2020-09-10, the area grew")


# A scene's own words


def test_own_words_replace_single_messages(write_scene: WriteScene) -> None:
    own = """
noun: {one: blaze, other: blazes}
areas: [{unit: area-acre, size: 4046.8564224}]
says: {grew: "gained {{ percent }}, now {{ area }}"}
"""
    assert scene_words(write_scene, own)[1] == (
        "Between 9 and 10 September the blaze gained 56%, now 154,000 ac and merged with two other "
        "blazes."
    )


def test_a_language_of_its_own_must_be_complete(write_scene: WriteScene) -> None:
    text = (FOLDER / "en.yaml").read_text(encoding="utf-8").replace("lang: en", "lang: nl")
    text = text.replace("Between {{ first }} and", "Tussen {{ first }} en")
    assert scene_words(write_scene, text)[1].startswith("Tussen 9 en 10 september the area grew")
    assert '"noun"' in refused(write_scene, "lang: nl")


def test_a_file_that_is_missing_or_outside_is_a_fault(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    path = write_scene(FIRE.format(head="story: {words: ../own.yaml}"))
    with pytest.raises(SceneError, match=r"cannot read ../own.yaml"):
        load(path)
    with pytest.raises(SceneError, match="outside of the sandbox"):
        load(path, tmp_path)


@pytest.mark.parametrize(
    ("own", "message"),
    [
        ("says: {grew: '{{ area }'}", "the message grew is no template"),
        ("says: {grow: x}", "unknown message 'grow': did you mean"),
        ("says: {grew: '{{ wind }}'}", "the message grew knows no 'wind', only area, percent"),
        ("says: {grew: {some: x, other: y}}", "unknown form 'some'"),
        ("says: {grew: {one: x}}", 'needs the form "other"'),
        ("noun: {one: x, other: y}\nnouns: z", 'unknown key "nouns"'),
        ("areas: [{unit: area-morgen, size: 2500}]", "area-morgen"),
        ("compass: [north]", "compass"),
        ("- a list", "expected a mapping"),
        ("says: {grew: '" + "x" * 3000 + "'}", "longer than 2000 characters"),
    ],
)
def test_faults_of_a_file_are_told(write_scene: WriteScene, own: str, message: str) -> None:
    text = refused(write_scene, own)
    assert message in text
    assert text.startswith("own.yaml:")


@pytest.mark.parametrize(
    "template",
    [
        "{% for a in area %}{{ a }}{% endfor %}",
        "{{ area.__class__.__mro__ }}",
        "{{ area['__class__'] }}",
        "{{ area.format(1) }}",
        "{{ range(10) }}",
        "{{ area * 1000000000 }}",
        "{{ 10 ** 10 }}",
        "{{ area|replace('a', 'b') }}",
        "{{ area|attr('upper') }}",
        "{% include '/etc/passwd' %}",
        "{% import 'x' as y %}",
        "{% set area = 1 %}",
        "{% macro m() %}{% endmacro %}",
        "{{ self }}",
        "{{ [area] }}",
    ],
)
def test_a_template_can_only_say(write_scene: WriteScene, template: str) -> None:
    own = yaml.safe_dump({"says": {"grew": template}})
    assert "the message grew" in refused(write_scene, own)


def test_markup_in_words_and_names_stays_text(write_scene: WriteScene) -> None:
    own = yaml.safe_dump({"says": {"grew": "<script>{{ percent }}</script>"}})
    assert "<script>56%</script>" in scene_words(write_scene, own)[1]
    square = "polygon: [[0, 0], [4, 0], [4, {}], [0, {}]]"
    name = "{{ 7 * 7 }} <img src=x onerror=alert(1)>"
    steps = "".join(
        f"  - {{polygons: [{{key: a, name: '{name}', {square.format(n, n)}}}]}}\n" for n in (4, 5)
    )
    assert f"{name} grew by 25%" in told(load(write_scene(f"title: t\nsteps:\n{steps}")))[1]


# What a page takes


def test_captions_are_the_authors_where_there_are_some(write_scene: WriteScene) -> None:
    text = FIRE.format(head="") + "    caption: Wind!\n"
    scene = load(write_scene(text))
    made = told(scene)
    assert captions(scene) == (made[0], "Wind!")
    assert alternative(scene) == (made[0], f"Wind! {made[1]}")
