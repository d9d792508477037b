"""Build scenes: plan, render, and write the files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from urllib.parse import quote

from markupsafe import Markup

from geotween.data.load import Scene
from geotween.data.problems import Problem
from geotween.export.between import BETWEEN
from geotween.export.cache import default_cache
from geotween.export.furniture.language import direction, words_in
from geotween.export.interchange import INTERCHANGE_FORMATS, interchange_files
from geotween.export.jobs import plan_scenes
from geotween.export.keyframes import Keyframes, keyframes
from geotween.export.page import inline
from geotween.export.pages import PAGE_FORMATS, height_in_frame, page_files, shared_files
from geotween.export.pictures.formats import PICTURE_FORMATS, Pictures, picture_files
from geotween.export.pictures.picture import Shown
from geotween.export.plans import Plan, tasks_of
from geotween.export.reports import TransitionReport, problems_of, transition_reports
from geotween.export.site import Site, render
from geotween.export.svg import animated_svg, still_svg
from geotween.export.words import words
from geotween.motion.morph import Morph, plan
from geotween.scene.model import SceneFile
from geotween.story.captions import told

FORMATS = ("html", "svg")
KNOWN_FORMATS = tuple(
    dict.fromkeys([*FORMATS, *PAGE_FORMATS, *INTERCHANGE_FORMATS, *PICTURE_FORMATS])
)
INDEX = "index.html"


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
    """A scene's files before they are written, by name.

    ``size`` is that of the map, ``height`` what its page takes in a frame of the usual width (px).
    """

    name: str
    files: Mapping[str, bytes]
    size: tuple[float, float]
    height: int
    card: Card
    transitions: tuple[TransitionReport, ...]
    projection: str
    problems: tuple[Problem, ...]


def build(
    scene: Scene,
    out_dir: str | os.PathLike[str],
    formats: Iterable[str] = FORMATS,
    *,
    jobs: int = 1,
    cache: bool = True,
    executor: Executor | None = None,
    site: Site | None = None,
) -> BuildReport:
    """Write a scene as ``<name>.html`` and ``<name>.svg`` into a folder.

    The files are the same however they are made.

    Parameters
    ----------
    jobs
        In how many processes transitions are planned; more than one need the calling script to be
        guarded by ``if __name__ == "__main__"``.
    cache
        Whether plans are looked up, and kept, in the user's cache (GEOTWEEN_CACHE).
    executor
        Plans the transitions instead: any ``concurrent.futures.Executor``, such as
        ``Client.get_executor()`` of dask.distributed, whose workers have geotween, too.
    site
        The site that the page is for: its address, its own templates.

    Raises
    ------
    ValueError
        For an unknown format.
    OSError
        Where the folder cannot be written to; nothing is written then.
    """
    folder, wanted = writable(out_dir), known_formats(formats)
    kept = default_cache() if cache else None
    (plans,) = plan_scenes([scene], jobs=jobs, cache=kept, executor=executor)
    rendered = render_scene(scene, wanted, plans=plans, site=site)
    shared = shared_files(wanted, site or Site())
    files = write(folder, {**rendered.files, **shared})
    return report(rendered, files[: len(rendered.files)])


def plan_scene(scene: Scene) -> tuple[list[Morph], list[Problem]]:
    """The motion of each transition with all that is behind it, and the problems of all."""
    morphs = [plan(t.origin, t.target, t.techniques) for t in tasks_of(scene)]
    return morphs, problems_of(scene, morphs)


def render_scene(
    scene: Scene,
    formats: Iterable[str] = FORMATS,
    *,
    index_href: str = "",
    plans: Sequence[Plan | Morph] | None = None,
    site: Site | None = None,
    between: int = BETWEEN,
    pictures: Pictures | None = None,
) -> Rendered:
    """Render a scene, planned first unless it is; nothing is written.

    ``between`` is the number of frames between two steps where frames are told as GeoJSON.
    """
    wanted = known_formats(formats)
    if plans is None:
        (plans,) = plan_scenes([scene])
    problems = problems_of(scene, plans)
    model, happened = scene.model, told(scene)
    frames = _captioned(keyframes(scene, plans), happened)
    svg_name, page_name = f"{scene.name}.svg", f"{scene.name}.html"
    svg_link = quote(svg_name) if "svg" in wanted else ""
    site = site or Site()
    files = page_files(scene.name, frames, model, happened, wanted, site, index_href)
    source = _source(model)
    description = model.description or model.subtitle
    around = words(frames, model.title, source) if "svg" in wanted else None
    if around:
        files[svg_name] = animated_svg(frames, model.title, description, around).encode()
    files |= interchange_files(scene, frames, plans, wanted, between)
    pictured, met = picture_files(
        scene.name,
        Shown(frames, model.title, source, description),
        wanted,
        pictures or Pictures(),
        shown_step(scene),
    )
    files |= pictured
    opened = next((name for name in (page_name, svg_name, *files) if name in files), "")
    card = Card(
        model.title,
        description,
        quote(opened),
        svg_link,
        inline(still_svg(frames, model.title, shown_step(scene), around)),
    )
    return Rendered(
        scene.name,
        files,
        (frames.page.width, frames.page.height),
        height_in_frame(frames, model, happened),
        card,
        transition_reports(scene, plans),
        scene.projection,
        (*problems, *frames.problems, *met),
    )


def shown_scene(scene: Scene, plans: Sequence[Plan | Morph]) -> Shown:
    """A planned scene as it goes into pictures."""
    model = scene.model
    description = model.description or model.subtitle
    return Shown(keyframes(scene, plans), model.title, _source(model), description)


def _source(model: SceneFile) -> str:
    """Where a map comes from, in one line."""
    named = words_in(model.lang)["source"].format(source=model.source) if model.source else ""
    return " · ".join(filter(None, [named, model.credit]))


def known_formats(formats: Iterable[str]) -> list[str]:
    """Formats by name, if all of them are known.

    Raises
    ------
    ValueError
        Where one is not.
    """
    wanted = list(formats)
    unknown = sorted(set(wanted) - set(KNOWN_FORMATS))
    if unknown:
        raise ValueError(f"unknown format {unknown[0]!r}; expected {' or '.join(KNOWN_FORMATS)}")
    return wanted


def _captioned(frames: Keyframes, happened: Sequence[str]) -> Keyframes:
    """Keyframes whose steps say what happened before them where the scene says nothing."""
    first, *others = zip(frames.captions, happened, strict=True)
    return replace(frames, captions=(first[0], *(caption or text for caption, text in others)))


def shown_step(scene: Scene) -> int:
    """The step for the still: the one nearest to the middle that has polygons."""
    middle = len(scene.steps) // 2
    full = [i for i, step in enumerate(scene.steps) if len(step.regions)]
    return min(full, key=lambda i: (abs(i - middle), i))


def gallery(cards: Sequence[Card], title: str, lang: str = "en", site: Site | None = None) -> bytes:
    """A page that shows several maps."""
    way = direction(lang)
    text = render(
        "index.html.j2", site or Site(), "index", lang=lang, dir=way, title=title, cards=cards
    )
    return text.encode()


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
