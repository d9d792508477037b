"""Build scenes: plan, render, and write the files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from urllib.parse import quote

from markupsafe import Markup

from geotween.data.load import Scene
from geotween.data.problems import Problem
from geotween.export.furniture.language import words_in
from geotween.export.keyframes import Keyframes, keyframes
from geotween.export.page import page, render
from geotween.export.svg import animated_svg, still_svg
from geotween.export.words import words
from geotween.motion.measure import measure
from geotween.motion.morph import Morph, plan
from geotween.motion.techniques import resolve
from geotween.scene.model import Motion
from geotween.story.captions import told

FORMATS = ("html", "svg")
INDEX = "index.html"


@dataclass(frozen=True)
class TransitionReport:
    """What happened between two steps: their labels, the pieces that moved, and measures.

    ``valid`` tells whether it was proved that polygons cross nowhere on the way; ``ways`` how many
    pieces of each layer were moved in which way.
    """

    steps: tuple[str, str]
    pieces: int
    valid: bool
    ways: Mapping[str, Mapping[str, int]]
    measures: Mapping[str, float]


@dataclass(frozen=True)
class BuildReport:
    """What a build wrote and met.

    ``bytes`` are the sizes of ``files``, in their order; ``projection`` says in words what plane
    the map is drawn in.
    """

    name: str
    files: tuple[Path, ...]
    bytes: tuple[int, ...]
    transitions: tuple[TransitionReport, ...]
    projection: str
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class Card:
    """A scene's entry in the gallery."""

    title: str
    description: str
    href: str
    svg_href: str
    still: Markup


@dataclass(frozen=True)
class Rendered:
    """A scene's files before they are written, by name."""

    name: str
    files: Mapping[str, bytes]
    card: Card
    transitions: tuple[TransitionReport, ...]
    projection: str
    problems: tuple[Problem, ...]


def build(
    scene: Scene, out_dir: str | os.PathLike[str], formats: Iterable[str] = FORMATS
) -> BuildReport:
    """Write a scene as ``<name>.html`` and ``<name>.svg`` into a folder.

    Raises
    ------
    ValueError
        For an unknown format.
    OSError
        Where the folder cannot be written to; nothing is written then.
    """
    folder = writable(out_dir)
    rendered = render_scene(scene, formats)
    return report(rendered, write(folder, rendered.files))


def plan_scene(scene: Scene) -> tuple[list[Morph], list[Problem]]:
    """The motion of each transition, and all problems with their steps named."""
    motion = scene.model.motion
    techniques = resolve(
        motion.method,
        motion.correspondence,
        motion.division,
        motion.matching,
        motion.path,
        motion.radius,
        motion.annexation,
        _exceptions(motion),
    )
    morphs, problems = [], list(scene.problems)
    for before, after in zip(scene.steps[:-1], scene.steps[1:], strict=True):
        planned = plan(before.regions, after.regions, techniques)
        morphs.append(planned)
        problems += [
            replace(p, steps=(before.label, after.label)) for p in planned.certificate.problems
        ]
    return morphs, problems


def _exceptions(motion: Motion) -> dict[tuple[str, str], str]:
    """The methods that a scene names for layers, classes and keys."""
    rules = {"layer": motion.by_layer, "class": motion.by_class, "key": motion.by_key}
    return {
        (what, name): rule.method for what, those in rules.items() for name, rule in those.items()
    }


def transition_reports(
    scene: Scene, morphs: Sequence[Morph], *, in_frames: bool = False
) -> tuple[TransitionReport, ...]:
    """What is proved and measured of each transition; ``in_frames`` looks at 201 frames, too."""
    reports = []
    for before, after, m in zip(scene.steps[:-1], scene.steps[1:], morphs, strict=True):
        certificate = m.certificate
        measures = dict(certificate.measures)
        if in_frames:
            found = asdict(measure(m.tracks, before.regions, after.regions))
            measures |= {name.replace("_", " "): value for name, value in found.items()}
        steps = (before.label, after.label)
        reports.append(
            TransitionReport(steps, len(m.tracks), certificate.valid, certificate.ways, measures)
        )
    return tuple(reports)


def render_scene(
    scene: Scene, formats: Iterable[str] = FORMATS, *, index_href: str = ""
) -> Rendered:
    """Plan a scene and render it; nothing is written."""
    wanted = list(formats)
    unknown = sorted(set(wanted) - set(FORMATS))
    if unknown:
        raise ValueError(f"unknown format {unknown[0]!r}; expected {' or '.join(FORMATS)}")
    morphs, problems = plan_scene(scene)
    model, happened = scene.model, told(scene)
    frames = _captioned(keyframes(scene, morphs), happened)
    svg_name, page_name = f"{scene.name}.svg", f"{scene.name}.html"
    svg_link = quote(svg_name) if "svg" in wanted else ""
    files: dict[str, bytes] = {}
    if "html" in wanted:
        # What a caption says already is not said again.
        alts = [
            "" if text == caption else text
            for text, caption in zip(happened, frames.captions, strict=True)
        ]
        text = page(
            frames,
            model,
            svg_href=svg_link,
            index_href=index_href,
            alternative=happened,
            alts=alts,
        )
        files[page_name] = text.encode()
    named = words_in(model.lang)["source"].format(source=model.source) if model.source else ""
    origins = [named, model.credit]
    source = " · ".join(filter(None, origins))
    description = model.description or model.subtitle
    around = words(frames, model.title, source) if "svg" in wanted else None
    if around:
        files[svg_name] = animated_svg(frames, model.title, description, around).encode()
    card = Card(
        model.title,
        description,
        quote(page_name if "html" in wanted else svg_name),
        svg_link,
        Markup(still_svg(frames, model.title, _shown_step(scene), around)),
    )
    return Rendered(
        scene.name,
        files,
        card,
        transition_reports(scene, morphs),
        scene.projection,
        (*problems, *frames.problems),
    )


def _captioned(frames: Keyframes, happened: Sequence[str]) -> Keyframes:
    """Keyframes whose steps say what happened before them where the scene says nothing."""
    first, *others = zip(frames.captions, happened, strict=True)
    return replace(frames, captions=(first[0], *(caption or text for caption, text in others)))


def _shown_step(scene: Scene) -> int:
    """The step for the still: the one nearest to the middle that has polygons."""
    middle = len(scene.steps) // 2
    full = [i for i, step in enumerate(scene.steps) if len(step.regions)]
    return min(full, key=lambda i: (abs(i - middle), i))


def gallery(cards: Sequence[Card], title: str, lang: str = "en") -> bytes:
    """A page that shows several maps."""
    return render("index.html.j2", lang=lang, title=title, cards=cards).encode()


def report(rendered: Rendered, files: Sequence[Path]) -> BuildReport:
    """The report of a scene whose files have been written."""
    sizes = tuple(len(content) for content in rendered.files.values())
    return BuildReport(
        rendered.name,
        tuple(files),
        sizes,
        rendered.transitions,
        rendered.projection,
        rendered.problems,
    )


def writable(out_dir: str | os.PathLike[str]) -> Path:
    """The folder, if files can be written to it; it is not made yet.

    Raises
    ------
    OSError
        Where they cannot.
    """
    folder = Path(out_dir)
    nearest = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not nearest.is_dir():
        raise NotADirectoryError(20, "is a file, not a folder; name another with -o", str(nearest))
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise PermissionError(13, "permission denied", str(nearest))
    return folder


def write(folder: Path, files: Mapping[str, bytes]) -> list[Path]:
    """Write files under temporary names first, then put all of them in place."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in files:
        if (folder / name).is_dir():
            raise IsADirectoryError(21, "a folder of that name is there", str(folder / name))
    with ExitStack() as clean_up:
        ready: list[tuple[Path, Path]] = []
        for name, content in files.items():
            handle, temporary = tempfile.mkstemp(prefix=".geotween-", dir=folder)
            clean_up.callback(Path(temporary).unlink, missing_ok=True)
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            _as_new_file(Path(temporary))
            ready.append((Path(temporary), folder / name))
        for made, place in ready:
            made.replace(place)
    return [folder / name for name in files]


def _as_new_file(path: Path) -> None:
    """Give a temporary file the permissions that a new file gets."""
    mask = os.umask(0)
    os.umask(mask)
    path.chmod(0o666 & ~mask)
