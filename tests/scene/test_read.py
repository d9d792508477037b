"""What a scene may say: each wrong value is told at its place, by name, with what was expected."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import Any

import pytest

from geotween.scene.document import Document
from geotween.scene.errors import Fault, SceneError
from geotween.scene.model import SceneFile
from geotween.scene.read import read_scene

STEPS = "steps:\n  - polygons: []\n  - polygons: []\n"

COLOUR = (
    'expected a colour, a hex value like "#c1440e" (in quotes), a CSS name like steelblue, '
    "or none, not "
)
TRANSITION = (
    '"transition": expected seconds from 0.05 to 3600, a list of them (one for each transition), '
    "or proportional"
)
TIME = '"time": expected a date (2024-01-05), a date-time (2024-01-05T12:30) or a number'


def scene_and_faults(text: str) -> tuple[SceneFile | None, list[Fault]]:
    scene, _, faults = read_scene(Document("s.yaml", Path("s.yaml"), text))
    return scene, faults


def scene(head: str = "", steps: str = STEPS) -> SceneFile:
    model, faults = scene_and_faults(f"title: t\n{head}\n{steps}")
    assert model is not None
    assert not faults
    return model


def told(text: str) -> list[tuple[int, int, str]]:
    return [(f.line, f.column, f.message) for f in sorted(scene_and_faults(text)[1])]


def hints(text: str) -> list[str]:
    return [fault.hint for fault in scene_and_faults(text)[1]]


def test_a_key_that_stands_twice_hides_no_other_fault() -> None:
    text = "title: t\ntitle: u\nsteps:\n  - {polygons: [], hold: x}\n  - {polygons: []}\n"
    assert [line for line, _, _ in told(text)] == [2, 4]


def test_times_are_checked_in_a_scene_with_other_faults() -> None:
    steps = "steps:\n  - {time: 1990, polygons: []}\n  - {time: 2024-01-05, polygons: []}\n"
    text = f"title: [t]\ntiming: {{total: 3, speed: fast}}\n{steps}"
    assert [line for line, _, _ in told(text)] == [1, 2, 2, 5]


def test_shortest_scene_has_a_title_and_two_steps() -> None:
    model = scene()
    assert model.title == "t"
    assert [step.polygons for step in model.steps] == [[], []]
    assert model.timing.transition == 2.0


@pytest.mark.parametrize("title", ["no", "12:30", "2024-01-05", "017", "1_000", "1984", "true"])
def test_title_is_the_text_that_was_written(title: str) -> None:
    model, _ = scene_and_faults(f"title: {title}\n{STEPS}")
    assert model is not None
    assert model.title == title


@pytest.mark.parametrize(
    ("written", "number"),
    [("900", 900), ("0900", 900), ("5_00", 500), ('"9e2"', 900), ("60.5", 60.5)],
)
def test_number_is_read_from_its_text(written: str, number: float) -> None:
    assert scene(f"map: {{width: {written}}}").map.width == number


@pytest.mark.parametrize(
    ("written", "value"),
    [(word, True) for word in ("true", "True", "yes", "on", "1")]
    + [(word, False) for word in ("false", "FALSE", "no", "off", "0", '"no"')],
)
def test_boolean_is_read_as_people_write_it(written: str, value: bool) -> None:
    assert scene(f"timing: {{loop: {written}}}").timing.loop is value


def test_option_without_a_value_keeps_its_default() -> None:
    assert scene("map: {fit: ~, width: }") == scene()


@pytest.mark.parametrize(
    ("written", "colour"),
    [("red", "#ff0000"), ("'#C1440E'", "#c1440e"), ("'#abc'", "#aabbcc"), ("none", "none")],
)
def test_colour_is_a_name_a_hex_value_or_none(written: str, colour: str) -> None:
    assert scene(f"style: {{fill: {written}}}").style.fill == colour


def test_classes_and_keys_may_look_like_numbers_and_booleans() -> None:
    style = scene("style: {class: {no: {fill: red}}, key: {017: {width: 2}}}").style
    assert style.by_class["no"].fill == "#ff0000"
    assert style.by_key["017"].width == 2


# A wrong value: the line after the title, the column of the value, what is told


@pytest.mark.parametrize(
    ("line", "column", "message"),
    [
        ("subtitle: {a: b}", 11, '"subtitle": expected a text, not a mapping'),
        (r'source: "a\a"', 9, '"source": the character U+0007 cannot be shown; remove it'),
        ("lang: [en]", 7, '"lang": expected a text, not a list'),
        ("lang: in English", 7, '"lang": expected a language code such as en or pt-BR'),
        ("map: 5", 6, '"map": expected a mapping (key: value), not "5"'),
        ("map: {width: wide}", 14, '"width": expected a number, not "wide"'),
        ("map: {width: 12:30}", 14, '"width": expected a number, not "12:30"'),
        ("map: {width: [5]}", 14, '"width": expected a number, not a list'),
        ("map: {width: nan}", 14, '"width": expected a finite number, not "nan"'),
        ("map: {width: 1e999}", 14, '"width": expected a finite number, not "1e999"'),
        ("map: {width: 49}", 14,
         '"width": expected a number greater than or equal to 50, not "49"'),
        ("map: {height: 1e5}", 15,
         '"height": expected a number less than or equal to 10000, not "1e5"'),
        ("map: {padding: -1}", 16,
         '"padding": expected a number greater than or equal to 0, not "-1"'),
        ("map: {padding: 480}", 6, '"map": a padding of 480 px leaves no room for the map'),
        ("map: {height: 60, padding: 30}", 6,
         '"map": a padding of 30 px leaves no room for the map'),
        ("map: {background: reddish}", 19, f'"background": {COLOUR}"reddish"'),
        ("map: {background: '#c1440e80'}", 19,
         '"background": a colour here is solid; use opacity for see-through'),
        ("map: {fit: eahc}", 12, '"fit" cannot be "eahc"'),
        ("map: {y: [up]}", 10, '"y" cannot be a list'),
        ("map: {layers: 5}", 15, '"layers": expected a list, not "5"'),
        ("map: {layers: [5]}", 16, 'layer 1: expected a mapping (key: value), not "5"'),
        ("map: {layers: [{name: a}]}", 16, 'layer 1 needs "polygons"'),
        ("style: {stroke: 12px}", 17, f'"stroke": {COLOUR}"12px"'),
        ("style: {width: thick}", 16, '"width": expected a number, not "thick"'),
        ("style: {opacity: 1.5}", 18,
         '"opacity": expected a number less than or equal to 1, not "1.5"'),
        ("style: {class: [a]}", 16, '"class": expected a mapping (key: value), not a list'),
        ("style: {class: {a: red}}", 20, '"a": expected a mapping (key: value), not "red"'),
        ("style: {key: {a: {fill: redd}}}", 25, f'"fill": {COLOUR}"redd"'),
        ("motion: fast", 9, '"motion": expected a mapping (key: value), not "fast"'),
        ("motion: {method: papr}", 18, '"method" cannot be "papr"'),
        ("motion: {correspondence: keys}", 26, '"correspondence" cannot be "keys"'),
        ("motion: {division: cut}", 20, '"division" cannot be "cut"'),
        ("motion: {matching: 3}", 20, '"matching" cannot be "3"'),
        ("motion: {easing: fast}", 18, '"easing" cannot be "fast"'),
        ("motion: {ghost: yes}", 17, '"ghost" cannot be "yes"'),
        ("timing: 3", 9, '"timing": expected a mapping (key: value), not "3"'),
        ("timing: {transition: 0}", 22, TRANSITION),
        ("timing: {transition: 3601}", 22, TRANSITION),
        ("timing: {transition: nan}", 22, TRANSITION),
        ("timing: {transition: soon}", 22, TRANSITION),
        ("timing: {transition: []}", 22, TRANSITION),
        ("timing: {transition: [1, fast]}", 22, TRANSITION),
        ("timing: {transition: {a: 1}}", 22, TRANSITION),
        ("timing: {transition: [1, 2]}", 22, "2 transition times for 1 transitions"),
        ("timing: {total: -1}", 17,
         '"total": expected a number greater than or equal to 0, not "-1"'),
        ("timing: {total: 5}", 10, '"total" goes with transition: proportional'),
        ("timing: {hold: no}", 16, '"hold": expected a number, not "no"'),
        ("timing: {hold: 3601}", 16,
         '"hold": expected a number less than or equal to 3600, not "3601"'),
        ("timing: {loop: maybe}", 16, '"loop": expected true or false, not "maybe"'),
        ("timing: {loop: [1]}", 16, '"loop": expected true or false, not a list'),
        ("timing: {speed: 0}", 17, '"speed": expected a number greater than 0, not "0"'),
    ],
)  # fmt: skip
def test_wrong_value_is_told_at_its_place(line: str, column: int, message: str) -> None:
    assert told(f"title: t\n{line}\n{STEPS}") == [(2, column, message)]


@pytest.mark.parametrize(
    ("step", "column", "message"),
    [
        ("5", 5, 'step 1: expected a mapping (key: value), not "5"'),
        ("[1]", 5, "step 1: expected a mapping (key: value), not a list"),
        ("{}", 5, 'step 1 needs "polygons"'),
        ("{polygons: ~}", 5, 'step 1 needs "polygons"'),
        ("{polygons: [], label: [a]}", 27, '"label": expected a text, not a list'),
        ("{polygons: [], caption: {}}", 29, '"caption": expected a text, not a mapping'),
        ("{polygons: [], hold: -1}", 26,
         '"hold": expected a number greater than or equal to 0, not "-1"'),
        ("{polygons: [], time: soon}", 26, TIME),
        ("{polygons: [], time: 2024-13-45}", 26, TIME),
        ("{polygons: [], time: 12:30}", 26, TIME),
        ("{polygons: [], time: [1]}", 26, TIME),
        ("{polygons: [], time: 1e999}", 26,
         '"time": expected a number of at most 1e+15, not 1e999'),
    ],
)  # fmt: skip
def test_wrong_value_in_a_step_is_told_at_its_place(step: str, column: int, message: str) -> None:
    assert told(f"title: t\nsteps:\n  - {step}\n  - polygons: []\n") == [(3, column, message)]


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("", (1, 1), "the scene is empty"),
        ("# nothing\n", (1, 1), "the scene is empty"),
        ("a", (1, 1), "expected a mapping (key: value)"),
        ("[1, 2]", (1, 1), "expected a mapping (key: value)"),
        (STEPS, (1, 1), 'the scene needs "title"'),
        (f"title:\n{STEPS}", (1, 1), 'the scene needs "title"'),
        (f"title: [a]\n{STEPS}", (1, 8), '"title": expected a text, not a list'),
        ("title: t\n", (1, 1), 'the scene needs "steps"'),
        ("title: t\nsteps: 5", (2, 8), '"steps": expected a list, not "5"'),
        ("title: t\nsteps: {a: b}", (2, 8), '"steps": expected a list, not a mapping'),
        ("title: t\nsteps: []", (2, 1), "a scene needs at least two steps, not 0"),
        ("title: t\nsteps: [{polygons: []}]", (2, 1), "a scene needs at least two steps, not 1"),
        ("title: t\nsteps: [~, {polygons: []}]", (2, 9),
         "step 1: expected a mapping (key: value), not nothing"),
    ],
)  # fmt: skip
def test_scene_that_lacks_its_shape(text: str, place: tuple[int, int], message: str) -> None:
    try:
        faults = scene_and_faults(text)[1]
    except SceneError as error:
        faults = list(error.faults)
    assert [((f.line, f.column), f.message) for f in faults] == [(place, message)]


# Unknown keys


@pytest.mark.parametrize(
    ("line", "column", "hint"),
    [
        ("titel: t", 1, 'did you mean "title"?'),
        ("Map: {}", 1, 'did you mean "map"?'),
        ("map: {widht: 5}", 7, 'did you mean "width"?'),
        ("map: {layers: [{polygons: [], fil: red}]}", 31, 'did you mean "fill"?'),
        ("style: {classes: {}}", 9, 'did you mean "class"?'),
        ("style: {by_class: {}}", 9, 'did you mean "class"?'),
        ("style: {class: {a: {strok: red}}}", 21, 'did you mean "stroke"?'),
        ("style: {key: {a: {colour: red}}}", 19, 'did you mean "fill"?'),
        ("style: {key: {a: {grosor: 1}}}", 19, "known here: fill, opacity, stroke, width"),
        ("captions: []", 1, '"caption" belongs under steps'),
        ("times: [1, 2]", 1, '"times" belongs under data'),
        ("projection: auto", 1, '"projection" belongs under map'),
        ("motion: {devision: voronoi}", 10, 'did you mean "division"?'),
        ("timing: {hold_: 1}", 10, 'did you mean "hold"?'),
    ],
)
def test_unknown_key_is_told_with_the_nearest_known_one(line: str, column: int, hint: str) -> None:
    (fault,) = scene_and_faults(f"title: t\n{line}\n{STEPS}")[1]
    assert (fault.line, fault.column) == (2, column)
    assert fault.message.startswith('unknown key "')
    assert fault.hint == hint


def test_misspelt_word_is_told_with_the_nearest_known_one() -> None:
    assert hints(f"title: t\nmotion: {{method: papr}}\n{STEPS}") == ['did you mean "paper"?']


def test_unknown_key_in_a_step_and_what_it_was_meant_to_be() -> None:
    text = "title: t\nsteps: [{polygon: []}, {polygons: []}]"
    assert told(text) == [
        (2, 9, 'step 1 needs "polygons"'),
        (2, 10, 'unknown key "polygon"'),
    ]


def test_all_faults_of_a_scene_come_at_once() -> None:
    text = "titel: t\nmap: {width: wide, zoom: 3}\nsteps:\n  - {polygons: [], hold: x}\n  - 5\n"
    assert told(text) == [
        (1, 1, 'the scene needs "title"'),
        (1, 1, 'unknown key "titel"'),
        (2, 14, '"width": expected a number, not "wide"'),
        (2, 20, 'unknown key "zoom"'),
        (4, 26, '"hold": expected a number, not "x"'),
        (5, 5, 'step 2: expected a mapping (key: value), not "5"'),
    ]


# Times


@pytest.mark.parametrize(
    ("written", "time"),
    [
        ("1984", 1984.0),
        ("-1200000", -1.2e6),
        ("0.5", 0.5),
        ("1e3", 1000.0),
        ("2024-01-05", datetime.date(2024, 1, 5)),
        ("'2024-01-05'", datetime.date(2024, 1, 5)),
        ("2024-01-05T12:30", datetime.datetime(2024, 1, 5, 12, 30)),
        ("2024-01-05 12:30:15", datetime.datetime(2024, 1, 5, 12, 30, 15)),
        ("2024-01-05T12:30Z", datetime.datetime(2024, 1, 5, 12, 30, tzinfo=datetime.UTC)),
        (
            "2024-01-05T12:30+02:00",
            datetime.datetime(2024, 1, 5, 10, 30, tzinfo=datetime.UTC),
        ),
    ],
)
def test_time_is_a_date_a_date_time_or_a_number(written: str, time: Any) -> None:
    model = scene(steps=f"steps: [{{time: {written}, polygons: []}}, {{polygons: []}}]")
    assert model.steps[0].time == time
    assert type(model.steps[0].time) is type(time)


def steps(*times: str) -> str:
    return "".join(
        ["steps:\n"]
        + [f"  - {{time: {t}, polygons: []}}\n" if t else "  - polygons: []\n" for t in times]
    )


@pytest.mark.parametrize(
    "times",
    [
        ["2024-01-05", "5"],
        ["2024-01-05", "2024-01-05T12:30"],
        ["2024-01-05T12:30", "2024-01-05T12:30Z"],
        ["", "5", "2024-01-05"],
    ],
)
def test_times_of_two_kinds_are_refused_at_the_odd_one(times: list[str]) -> None:
    (fault,) = scene_and_faults(f"title: t\n{steps(*times)}")[1]
    assert (fault.line, fault.column) == (2 + len(times), 12)
    assert fault.message.startswith('"time": one step\'s time is a ')
    assert "write all times of a scene as dates" in fault.hint


def test_date_times_of_two_zones_are_of_one_kind() -> None:
    scene(steps=steps("2024-01-05T12:30Z", "2024-01-05T12:30+02:00"))


# Timing


def test_transition_list_has_one_entry_for_each_pair_of_steps() -> None:
    assert scene("timing: {transition: [1, 2.5]}", steps("1", "2", "3")).timing.transition == (
        1,
        2.5,
    )


PROPORTIONAL = "title: t\ntiming: {transition: proportional, total: 9}\n"


def test_proportional_timing_with_a_total() -> None:
    model, faults = scene_and_faults(PROPORTIONAL + steps("1", "2", "5"))
    assert model is not None
    assert (model.timing.transition, model.timing.total, faults) == ("proportional", 9, [])


def test_proportional_timing_needs_a_time_for_each_step() -> None:
    message = "proportional timing needs a time for each step; step {} has none"
    assert told(PROPORTIONAL + steps("1", "", "", "4", "")) == [
        (5, 5, message.format(2)),
        (6, 5, message.format(3)),
        (8, 5, message.format(5)),
    ]


def test_proportional_timing_needs_different_times() -> None:
    assert told(PROPORTIONAL + steps("1", "2", "2.0", "5")) == [
        (6, 12, "proportional timing: steps 2 and 3 have the same time")
    ]


def test_total_without_proportional_timing_is_refused() -> None:
    text = f"title: t\ntiming: {{transition: [1, 2, 3], total: 4}}\n{steps('1', '2')}"
    assert told(text) == [
        (2, 22, "3 transition times for 1 transitions"),
        (2, 33, '"total" goes with transition: proportional'),
    ]
