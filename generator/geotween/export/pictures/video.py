"""Moving pictures: GIF, animated WebP and PNG by Pillow, MP4 by FFmpeg."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable
from dataclasses import replace
from io import BytesIO
from itertools import accumulate, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geotween.export.pictures.extras import needed
from geotween.export.pictures.film import Film, images
from geotween.export.pictures.moments import thinned

if TYPE_CHECKING:
    from PIL.Image import Image

Done = Callable[[int], object]
Timed = list[tuple["Image", int]]

# Pictures from which the colours of a GIF are taken, evenly over the film.
LOOKS = 12
# What is given up to make a GIF smaller, in this order: colours, and frames of which one is kept.
TRADES = ((256, 1), (128, 1), (64, 1), (64, 2), (32, 2), (32, 3), (16, 4))

CRF = "20"  # x264's constant quality: 18 cannot be told from the original, 23 is its default
PRESET = "veryfast"  # of even areas it makes smaller files than slower ones
# Colours as screens have them: what players assume of films this large, said and meant.
COLOURS = ["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"]


def mp4(film: Film, jobs: int = 1, done: Done = lambda _: None) -> bytes:
    """A film as MP4 (H.264, without sound) that plays wherever video does.

    Raises
    ------
    MissingExtraError
        Where imageio-ffmpeg, or what draws pictures, is not installed.
    """
    ffmpeg = needed("imageio_ffmpeg", "an MP4")
    film = replace(film, even=True)  # H.264 halves the resolution of colours
    with tempfile.TemporaryDirectory(prefix="geotween-") as folder:
        path = Path(folder) / "film.mp4"
        writer = None
        for picture, count in images(film, jobs, done):
            if writer is None:
                writer = ffmpeg.write_frames(
                    str(path),
                    picture.size,
                    fps=film.rate,
                    codec="libx264",
                    macro_block_size=2,
                    quality=None,
                    output_params=[
                        *("-crf", CRF, "-preset", PRESET),
                        *("-vf", "scale=out_color_matrix=bt709:out_range=tv", *COLOURS),
                        *("-movflags", "+faststart", "-fflags", "+bitexact"),
                    ],
                )
                writer.send(None)
            pixels = picture.tobytes()
            for _ in range(count):
                writer.send(pixels)
        if writer is not None:
            writer.close()
        return path.read_bytes()


def gif(film: Film, jobs: int = 1, done: Done = lambda _: None, limit: int | None = None) -> bytes:
    """A film as GIF that repeats, in the colours that it has most of.

    Parameters
    ----------
    limit
        The most bytes it may have. Colours, then frames are given up until it has no more; the
        smallest one that can be made is larger at times.

    Raises
    ------
    MissingExtraError
        Where Pillow, or what draws pictures, is not installed.
    """
    whole = [*images(film, jobs, done)]
    made = b""
    for colours, every in TRADES:
        made = _gif(_every(whole, every), film.rate, colours)
        if limit is None or len(made) <= limit:
            break
    return made


def webp(film: Film, jobs: int = 1, done: Done = lambda _: None) -> bytes:
    """A film as animated WebP that repeats.

    Raises
    ------
    MissingExtraError
        Where Pillow, or what draws pictures, is not installed.
    """
    whole = [*images(film, jobs, done)]
    return _saved(whole, film.rate, format="WEBP", quality=85, method=2)


def apng(film: Film, jobs: int = 1, done: Done = lambda _: None) -> bytes:
    """A film as animated PNG that repeats, in all of its colours.

    Raises
    ------
    MissingExtraError
        Where Pillow, or what draws pictures, is not installed.
    """
    whole = [*images(film, jobs, done)]
    return _saved(whole, film.rate, format="PNG")


def _gif(whole: Timed, rate: float, colours: int) -> bytes:
    palette = _palette([picture for picture, _ in whole], colours)
    plain = [
        (picture.quantize(palette=palette, dither=_undithered()), count) for picture, count in whole
    ]
    return _saved(plain, rate, format="GIF", unit=10, optimize=False)


def _palette(pictures: list[Image], colours: int) -> Image:
    """The colours that pictures have most of, those of the film's beginning and end among them."""
    pillow = needed("PIL.Image", "a GIF")
    step = max(1, -(-len(pictures) // LOOKS))
    looked = [*pictures[::step], pictures[-1]]
    width, height = looked[0].size
    row = pillow.new("RGB", (width, height * len(looked)))
    for number, picture in enumerate(looked):
        row.paste(picture, (0, number * height))
    found: Image = row.quantize(colours, method=pillow.Quantize.MEDIANCUT, dither=_undithered())
    return found


def _undithered() -> Any:
    """Even areas stay even: dots would make films larger, and flicker."""
    return needed("PIL.Image", "a GIF").Dither.NONE


def _every(whole: Timed, every: int) -> Timed:
    """A film with one of so many frames, as long as before."""
    pictures = [picture for picture, _ in whole]
    numbered = thinned([(number, count) for number, (_, count) in enumerate(whole)], every)
    return [(pictures[number], count) for number, count in numbered]


def _saved(whole: Timed, rate: float, unit: int = 1, **options: Any) -> bytes:
    """Pictures as one file that repeats; durations in whole units of ms, and right in sum."""
    file = BytesIO()
    first, *others = [picture for picture, _ in whole]
    first.save(
        file,
        save_all=True,
        append_images=others,
        duration=durations((count for _, count in whole), rate, unit),
        loop=0,
        **options,
    )
    return file.getvalue()


def durations(counts: Iterable[int], rate: float, unit: int) -> list[int]:
    """How long (ms) runs of frames last, in whole units: each end is rounded, not each length."""
    ends = [0, *(unit * round(1000 * frames / rate / unit) for frames in accumulate(counts))]
    return [max(unit, end - start) for start, end in pairwise(ends)]
