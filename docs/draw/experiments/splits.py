"""Experiment 2: one polygon divided among its correspondents, by five techniques side by side."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon

from docs.draw.canvas import INK, Canvas
from docs.draw.experiments import pictures
from docs.draw.experiments.divisions import (
    LOSSES,
    NAMES,
    TERRITORY,
    THINNED,
    mean,
    moved,
    technique,
)
from docs.draw.experiments.page import Page
from docs.draw.experiments.seams import Turning, compared, seams_of
from docs.draw.experiments.shapes import FAMILIES
from docs.draw.experiments.tables import number, percent, table
from docs.draw.experiments.trials import (
    ONE_TO_MANY,
    OURS,
    PAPERS,
    SEEDS,
    WORDS,
    Loss,
    found,
    losses,
)
from geotween import mesh
from geotween.motion.tracks import frame

PICTURED = {"one to four": 0, "archipelago": 2, "drifted": 3}
MESHES = {"advancing front": mesh.advancing_front, "quadtree": mesh.quadtree}


def page() -> Page:
    """All of Experiment 2."""
    drawn = {"2-pipeline": pipeline(), "2-meshes": meshes()}
    for family, seed in PICTURED.items():
        drawn[f"2-{family.replace(' ', '-')}"] = _divided(family, seed)
    told = losses(OURS)
    worst = {(loss.figure, loss.rival): loss for loss in reversed(told) if _can_be_drawn(loss)}
    drawn |= {_name(loss): _pictured(loss) for loss in worst.values()}
    shown = [
        {"name": _name(loss), "words": WORDS[loss.figure]} | vars(loss)
        for loss in sorted(worst.values(), key=lambda loss: list(WORDS).index(loss.figure))
    ]
    drawn["2-rotation"] = _rotated()
    values = {
        "meshes": _mesh_table(),
        "divided": _division_table(),
        "motion": _motion_table(OURS, NAMES),
        "papers": _motion_table(PAPERS, (*NAMES, THINNED)),
        "losses": _loss_table(told),
        "papers_losses": _loss_table(losses(PAPERS)),
        "words": WORDS,
        "thick": _mean(PAPERS, TERRITORY, "lost"),
        "thin": _mean(PAPERS, THINNED, "lost"),
        "shown": shown,
        "seeds": len(SEEDS),
        "transitions": len(SEEDS) * len(FAMILIES),
        "pictured": PICTURED,
    }
    return Page("2-divisions", values, drawn, _times(), told=_told(told))


# The pipeline, and the meshes.


def pipeline() -> str:
    """One polygon, its correspondents, seeds and cells, pairs of pieces, half-way."""
    (polygon,), targets = FAMILIES["one to four"](0)
    titles = ("origin", "and its correspondents", "pieces", "the target", "half-way")
    box = pictures.box_of([polygon], targets)
    canvas = Canvas(box, titles, pictures.WIDTH, label="One polygon becomes four, in five stages")
    colours = pictures.PIECES
    canvas.area(0, polygon, pictures.BEFORE, stroke=INK, stroke_width=0.7)
    canvas.area(1, polygon, pictures.BEFORE, stroke=INK, stroke_width=0.7)
    pieces = technique(TERRITORY)(polygon, targets)
    for k, target in enumerate(targets):
        canvas.area(1, target, pictures.AFTER, fill_opacity=0.7, stroke=INK, stroke_width=0.7)
        canvas.area(2, pieces[k], colours[k], stroke="#ffffff", stroke_width=1.2)
        canvas.area(3, target, colours[k], stroke=INK, stroke_width=0.5)
    tracks = moved(FAMILIES["one to four"](0), TERRITORY, OURS).tracks
    for track in tracks:
        colour = colours[int(track.ends[1].key)]
        canvas.area(4, frame([track], 0.5).polygons, colour, stroke=INK, stroke_width=0.4)
    return canvas.svg()


def blob() -> Polygon:
    """The polygon that is meshed."""
    return FAMILIES["one to four"](0)[0][0]


def meshes() -> str:
    """Both meshes of one blob."""
    made = {name: make(blob()) for name, make in MESHES.items()}
    return pictures.meshes(made, "Triangles of both meshes, coloured by their quality")


def mesh_shares() -> dict[str, float]:
    """The share of good triangles in the meshes of all blobs, by technique."""
    blobs = [FAMILIES[family](seed)[0][0] for family in ONE_TO_MANY for seed in SEEDS]
    return {
        name: float(np.mean([mesh.share_good(make(blob)) for blob in blobs]))
        for name, make in MESHES.items()
    }


def _mesh_table() -> str:
    papers = {"advancing front": "about 96%", "quadtree": "about 41%"}
    shares = mesh_shares()
    rows = []
    for name, make in MESHES.items():
        made = make(blob())
        values = mesh.quality(made)
        one = [number(len(values)), number(values.mean(), 2), number(values.min(), 2)]
        rows.append([name, *one, f"{mesh.share_good(made):.1%}", f"{shares[name]:.1%}"])
        rows[-1].append(papers[name])
    heads = ["mesh", "triangles", "mean quality", "least", "0.8 or better", "of all blobs", "paper"]
    return table(heads, rows)


# The divisions.


def _pieces(family: str, seed: int) -> tuple[Polygon, Sequence[Polygon], dict[str, Any]]:
    (polygon,), targets = FAMILIES[family](seed)
    return polygon, targets, {name: technique(name)(polygon, targets) for name in NAMES}


def _divided(family: str, seed: int) -> str:
    label = f"{family}, number {seed}, divided by five techniques"
    return pictures.divisions(*_pieces(family, seed), label)


def _division_table() -> str:
    """Seams and shares of the one polygon in the families that have one."""
    rows = []
    for family in ONE_TO_MANY:
        every = [_pieces(family, seed) for seed in SEEDS]
        for name in NAMES:
            seams, cut = Turning(0, 0.0, 0.0, 0.0), [0.0, 0.0]
            given: list[float] = []
            for polygon, targets, pieces in every:
                seams += compared(polygon, pieces[name])
                lines = seams_of(pieces[name])
                covered = shapely.intersection(lines, shapely.union_all(targets))
                cut[0] += shapely.length(covered).sum()
                cut[1] += shapely.length(lines).sum()
                given.append(_share_given(polygon, targets, pieces[name]))
            rows.append(
                [
                    family,
                    name,
                    number(seams.over),
                    number(360 * (seams.every - seams.least) / seams.seams),
                    number(360 * seams.least / seams.seams, 1),
                    f"{cut[0] / cut[1]:.0%}",
                    percent(float(np.mean(given))),
                ]
            )
    heads = [
        "set",
        "division",
        "beyond the least, °",
        "with what is not seen, °",
        "the least, °",
        "through shapes",
    ]
    return table([*heads, "given away"], rows, words=2)


def _share_given(polygon: Polygon, targets: Sequence[Polygon], pieces: Sequence[Any]) -> float:
    common = shapely.intersection(np.array(targets, dtype=object), polygon)
    kept = shapely.intersection(common, np.array(list(pieces), dtype=object))
    return max(0.0, float(1 - shapely.area(kept).sum() / shapely.area(common).sum()))


def _motion_table(matching: str, names: Sequence[str]) -> str:
    rows = []
    for family in FAMILIES:
        for name in names:
            every = [found(matching)[family, seed, name] for seed in SEEDS]
            one = mean(every)
            shares = [one.overlap, max(f.overlap for f in every), one.given_away, one.lost]
            shares += [one.invalid, one.area]
            proved = f"{sum(f.proved for f in every):.0f}"
            rows.append([family, name, *map(percent, shares), proved])
    heads = ["set", "division", "overlap", "worst", "given away", "laid bare", "invalid frames"]
    return table([*heads, "area off", "proved"], rows, words=2)


def _loss_table(told: Sequence[Loss]) -> str:
    rows = []
    for figure in LOSSES:
        for rival in (*NAMES[1:],):
            mine = [loss for loss in told if (loss.figure, loss.rival) == (figure, rival)]
            worst = f"{mine[0].family}, {mine[0].seed}" if mine else "–"
            values = (
                [_shown(figure, v) for v in (mine[0].ours, mine[0].theirs)] if mine else ["", ""]
            )
            rows.append([WORDS[figure], rival, worst, str(len(mine)), *values])
    heads = [
        "figure",
        "territory beside",
        "where it loses most",
        "losses",
        "territory",
        "the other",
    ]
    return table(heads, rows, words=3)


def _shown(figure: str, value: float) -> str:
    return f"{value:.0f}°" if figure == "roughness" else percent(value)


# The losses in pictures.


def _can_be_drawn(loss: Loss) -> bool:
    """Seams are drawn where one polygon is divided."""
    return loss.figure != "roughness" or loss.family in ONE_TO_MANY


def _name(loss: Loss) -> str:
    return f"2-loss-{loss.figure.replace('_', '-')}-{loss.rival.replace(' ', '-')}"


def _pictured(loss: Loss) -> str:
    """Half-way by territory and by the one that beats it; of seams the divisions themselves."""
    label = f"Territory loses to {loss.rival} in {WORDS[loss.figure]}: {loss.family}, {loss.seed}"
    transition = FAMILIES[loss.family](loss.seed)
    names = (TERRITORY, loss.rival)
    if loss.figure == "roughness":
        rows = {name: technique(name)(transition[0][0], transition[1]) for name in names}
        return pictures.divisions(transition[0][0], transition[1], rows, label)
    return pictures.beside(
        {name: moved(transition, name, OURS).tracks for name in names}, transition, label
    )


def _rotated() -> str:
    """The same polygon by the paper's matching, its seams with all their vertices and thinned."""
    family, seed = "one to four", 0
    transition = FAMILIES[family](seed)
    motions = {name: moved(transition, name, PAPERS).tracks for name in (TERRITORY, THINNED)}
    label = "The paper's matching, with all vertices of territory's seams and with few"
    return pictures.beside(motions, transition, label)


def _times() -> str:
    """Seconds that each division takes for all polygons of the one-to-many families."""
    rows = []
    for name in NAMES:
        start = time.perf_counter()
        for family in ONE_TO_MANY:
            for seed in SEEDS:
                (polygon,), targets = FAMILIES[family](seed)
                technique(name)(polygon, targets)
        spent = (time.perf_counter() - start) / (len(ONE_TO_MANY) * len(SEEDS))
        rows.append([name, number(1000 * spent, 1)])
    return table(["division", "ms for a polygon"], rows)


def _mean(matching: str, name: str, figure: str) -> str:
    """The mean of a figure over all transitions, as it is told."""
    every = [getattr(f, figure) for key, f in found(matching).items() if key[2] == name]
    return percent(float(np.mean(every)))


def _told(told: Sequence[Loss]) -> dict[str, Any]:
    """What the first page says of this one, in numbers."""

    def worse(name: str, figure: str) -> int:
        return sum((loss.figure, loss.rival) == (figure, name) for loss in told)

    def proved(name: str) -> int:
        return sum(f.proved > 0 for key, f in found(OURS).items() if key[2] == name)

    return {
        "over": partial(_mean, OURS),
        "papers": partial(_mean, PAPERS),
        "worse": worse,
        "proved": proved,
        "shares": {name: f"{share:.0%}" for name, share in mesh_shares().items()},
        "transitions": len(SEEDS) * len(FAMILIES),
    }
