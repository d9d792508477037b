"""Films: the frames of a map in a row, drawn in several processes, each picture once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

from geotween.export.jobs import processes
from geotween.export.pictures.moments import Moment
from geotween.export.pictures.picture import Shape, Shown, frame_svg
from geotween.export.pictures.pixels import image

if TYPE_CHECKING:
    from PIL.Image import Image

# Pictures that wait for each process, so that none of them waits for work.
AHEAD = 4


@dataclass(frozen=True, eq=False)
class Film:
    """What is filmed: moments with how many frames each of them lasts, at a rate (frames/s).

    ``width`` is that of the picture in pixels; ``even`` cuts it to even numbers of pixels.
    """

    shown: Shown
    moments: Sequence[tuple[Moment, int]]
    rate: float
    width: int
    shape: Shape | None = None
    even: bool = False

    @property
    def count(self) -> int:
        return sum(count for _, count in self.moments)


def images(
    film: Film, jobs: int = 1, done: Callable[[int], object] = lambda _: None
) -> Iterator[tuple[Image, int]]:
    """The pictures of a film in order, each with the number of frames that it lasts.

    SVGs are written here, and drawn in as many processes as there are jobs. Memory: a few pictures
    for each process. ``done`` is told how many frames are done.
    """
    jobs = min(jobs, len(film.moments))
    with processes(jobs) if jobs > 1 else _no_processes() as pool:
        waiting: deque[tuple[Future[Image], int]] = deque()
        for moment, count in film.moments:
            svg = frame_svg(film.shown, moment, film.width, film.shape)
            if pool is None:
                yield _drawn(svg, film.width, film.even), count
                done(count)
                continue
            waiting.append((pool.submit(_drawn, svg, film.width, film.even), count))
            if len(waiting) > AHEAD * jobs:
                yield _next(waiting, done)
        while waiting:
            yield _next(waiting, done)


def _no_processes() -> AbstractContextManager[None]:
    return nullcontext()


def _next(
    waiting: deque[tuple[Future[Image], int]], done: Callable[[int], object]
) -> tuple[Image, int]:
    drawing, count = waiting.popleft()
    picture = drawing.result()
    done(count)
    return picture, count


def _drawn(svg: str, width: int, even: bool) -> Image:
    picture = image(svg, width)
    if not even:
        return picture
    wide, high = picture.size
    return picture.crop((0, 0, wide - wide % 2, high - high % 2))
