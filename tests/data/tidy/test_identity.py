"""Identity: one feature for a key in a step, and layers where classes lie on each other."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import MultiPolygon, box

from geotween.data.load import load
from geotween.data.polygons import Feature
from geotween.data.tidy.identity import TwoClassesError, class_layers, merge_keys
from geotween.scene.model import Map
from tests.conftest import WriteScene
from tests.data.written import told

LOW, HIGH = box(0, 0, 10, 10), box(2, 2, 8, 8)
BESIDE, FAR = box(10, 0, 20, 10), box(30, 0, 34, 4)


def feature(shape: object, key: str | None = None, class_: str | None = None) -> Feature:
    return Feature(shape, key, class_)  # type: ignore[arg-type]


# Keys


def test_two_parts_with_one_key_become_one_feature() -> None:
    kept, told_ = merge_keys([feature(LOW, "a"), feature(FAR, "b"), feature(BESIDE, "a")], step="1")
    assert [(f.key, f.geometry.area) for f in kept] == [("a", 200), ("b", 16)]
    assert [(p.kind, p.severity, p.steps, p.measure) for p in told_] == [
        ("merged", "note", ("1",), 1)
    ]
    assert all(f.geometry.is_valid for f in kept)


def test_parts_that_lie_apart_keep_their_vertices() -> None:
    kept, _ = merge_keys([feature(LOW, "a"), feature(MultiPolygon([FAR]), "a")])
    assert shapely.equals_exact(kept[0].geometry, MultiPolygon([LOW, FAR]))


def test_features_without_a_key_stay_apart() -> None:
    features = [feature(LOW), feature(LOW), feature(FAR, "a")]
    assert merge_keys(features) == (features, [])


def test_attributes_that_differ_are_left_out() -> None:
    one = Feature(LOW, "a", attributes={"name": "Sea", "n": 1, "only": 2})
    other = Feature(FAR, "a", attributes={"name": "Sea", "n": 2})
    assert merge_keys([one, other])[0][0].attributes == {"name": "Sea"}


@pytest.mark.parametrize(
    ("classes", "words"), [(("x", "y"), '"x" and "y"'), ((None, "y"), 'none and "y"')]
)
def test_one_key_with_two_classes(classes: tuple[str | None, str], words: str) -> None:
    features = [feature(LOW, "a", classes[0]), feature(FAR, "a", classes[1])]
    with pytest.raises(TwoClassesError) as caught:
        merge_keys(features)
    assert str(caught.value) == f'features with the key "a" have the classes {words}'


@given(st.lists(st.tuples(st.sampled_from(["a", "b", None]), st.integers(0, 6)), max_size=8))
def test_merging_keeps_what_is_covered_and_leaves_each_key_once(
    parts: list[tuple[str | None, int]],
) -> None:
    features = [feature(box(3 * x, 0, 3 * x + 4, 4), key) for key, x in parts]
    kept, _ = merge_keys(features)
    keys = [f.key for f in kept if f.key is not None]
    assert sorted(keys) == sorted({key for key, _ in parts if key is not None})
    for key in keys:
        wanted = shapely.union_all([f.geometry for f in features if f.key == key])
        (found,) = (f.geometry for f in kept if f.key == key)
        assert found.is_valid
        assert found.equals(wanted)
    assert merge_keys(kept) == (kept, [])


# Classes


def layers(*steps: Sequence[Feature], **words: object) -> tuple[str, ...]:
    return class_layers(steps, Map(**words))[1]  # type: ignore[arg-type]


def test_classes_that_lie_on_each_other_are_layers_the_larger_one_below() -> None:
    nested = [feature(HIGH, None, "50 kt"), feature(LOW, None, "34 kt")]
    found, order = class_layers([nested, []], Map())
    assert order == ("34 kt", "50 kt")
    assert [[f.layer for f in step] for step in found] == [["50 kt", "34 kt"], []]


def test_classes_side_by_side_move_together() -> None:
    assert layers([feature(LOW, None, "x"), feature(BESIDE, None, "y")]) == ("regions",)


def test_border_drawn_twice_makes_no_layers() -> None:
    sliver = box(9.95, 0, 20, 10)
    assert layers([feature(LOW, None, "x"), feature(sliver, None, "y")]) == ("regions",)


def test_one_class_that_lies_on_itself_makes_no_layers() -> None:
    assert layers([feature(LOW, None, "x"), feature(HIGH, None, "x")]) == ("regions",)


def test_one_step_that_overlaps_makes_layers_for_all() -> None:
    apart = [feature(LOW, None, "x"), feature(FAR, None, "y")]
    over = [feature(LOW, None, "x"), feature(HIGH, None, "y")]
    assert layers(apart, over) == layers(over, apart) == ("x", "y")


def test_features_without_a_class_lie_lowest() -> None:
    step = [feature(LOW, None, "x"), feature(HIGH, None, "y"), feature(FAR)]
    found, order = class_layers([step], Map())
    assert order == ("regions", "x", "y")
    assert [f.layer for f in found[0]] == ["x", "y", "regions"]


def test_author_may_choose_layers_and_their_order() -> None:
    apart = [feature(LOW, None, "x"), feature(FAR, None, "y"), feature(BESIDE, None, "z")]
    over = [feature(LOW, None, "x"), feature(HIGH, None, "y")]
    assert layers(apart, classes="layers") == ("x", "z", "y")
    assert layers(apart, classes="layers", class_order=("y", "none")) == ("y", "x", "z")
    assert layers(over, classes="together") == ("regions",)
    assert layers([feature(LOW)], classes="layers") == ("regions",)


@given(st.permutations([(LOW, "x"), (HIGH, "y"), (FAR, "z"), (BESIDE, "x")]))
def test_order_of_layers_is_not_that_of_the_features(order: list[tuple[object, str]]) -> None:
    assert layers([feature(shape, None, name) for shape, name in order]) == ("x", "y", "z")


# In a scene


def polygons(*features: str) -> str:
    ring = "[[0, 0], [4, 0], [4, 4], [0, 4]]"
    inner = "[[1, 1], [3, 1], [3, 3], [1, 3]]"
    far = "[[6, 0], [9, 0], [9, 4], [6, 4]]"
    shapes = {"ring": ring, "inner": inner, "far": far}
    listed = (f.split() for f in features)
    return ", ".join(f"{{key: {k}, class: {c}, polygon: {shapes[s]}}}" for k, c, s in listed)


def test_key_with_two_classes_is_told_with_its_step(write_scene: WriteScene) -> None:
    one, two = polygons("a x ring", "b x far"), polygons("a x ring", "a y far")
    path = write_scene(f"title: t\nsteps:\n  - polygons: [{one}]\n  - polygons: [{two}]\n")
    assert told(path) == [
        'scene.yaml:4:15: 2: features with the key "a" have the classes "x" and "y" = '
        "leave the key out, or name a column that tells them apart"
    ]


def test_same_key_may_have_another_class_in_another_step(write_scene: WriteScene) -> None:
    one, two = polygons("a x ring"), polygons("a y ring")
    found = load(write_scene(f"title: t\nsteps: [polygons: [{one}], polygons: [{two}]]\n"))
    assert [step.regions.identities[0].class_ for step in found] == ["x", "y"]


def test_layers_of_a_scene(write_scene: WriteScene) -> None:
    step = polygons("a low ring", "b high inner")
    found = load(write_scene(f"title: t\nsteps: [polygons: [{step}], polygons: [{step}]]\n"))
    assert found.layer_order == ("low", "high")
    assert found.steps[0].regions.in_layer("low").polygons[0].area == 16  # nothing is cut out


def test_a_class_that_stands_alone_for_long_lies_above_the_larger_one() -> None:
    inner, outer = box(4, 4, 5, 5), box(0, 0, 9, 9)
    alone = [Feature(inner, class_="inner")]
    both = [Feature(inner, class_="inner"), Feature(outer, class_="outer")]
    _, order = class_layers([*[alone] * 100, both], Map())
    assert order == ("outer", "inner")


def test_a_class_may_be_called_as_the_layer_of_those_without_one() -> None:
    step = [Feature(box(0, 0, 9, 9)), Feature(box(1, 1, 5, 5), class_="regions")]
    (layered,), order = class_layers([step], Map(classes="layers"))
    assert [f.layer for f in layered] == ["", "regions"]
    assert order == ("", "regions")
