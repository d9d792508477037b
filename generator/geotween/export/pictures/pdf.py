"""Pictures as PDF: an SVG put on a page of its size by Typst, all of it as vectors."""

from __future__ import annotations

from xml.etree.ElementTree import fromstring

from geotween.export.pictures.extras import needed

POINTS = 0.75  # in a CSS pixel: 72 to the inch beside 96

# What is said comes in as inputs, so that nothing a scene says is read as markup.
_PAGE = """\
#set document(title: sys.inputs.title, date: none)
#set text(lang: sys.inputs.lang)
#set page(width: {width}pt, height: {height}pt, margin: 0pt, fill: none)
#image(bytes(sys.inputs.svg), format: "svg", width: 100%, alt: sys.inputs.alt)
"""


def pdf(svg: str, title: str, alternative: str = "", lang: str = "en") -> bytes:
    """An SVG as PDF of one page, with its title, and what a screen reader says of it.

    The same SVG makes the same bytes. Words that are left in it are set in a font of this
    computer's, and embedded.

    Raises
    ------
    MissingExtraError
        Where Typst is not installed.
    """
    typst = needed("typst", "a PDF")
    root = fromstring(svg)
    width, height = (POINTS * float(root.attrib[name]) for name in ("width", "height"))
    page = _PAGE.format(width=f"{width:.3f}", height=f"{height:.3f}")
    told = {"svg": svg, "title": title, "alt": alternative or title, "lang": lang.split("-")[0]}
    compiler = typst.Compiler(ignore_system_fonts="<text" not in svg)
    made: bytes = compiler.compile(input=page.encode(), format="pdf", sys_inputs=told)
    return made
