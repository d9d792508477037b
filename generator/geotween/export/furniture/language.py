"""The language of a page: the way its script runs, and the words that are not the scene's."""

from __future__ import annotations

from functools import cache
from typing import Literal

import yaml

from geotween.export.resources import resource

DEFAULT = "en"

# Primary subtags (BCP 47) of languages that are written from right to left, and scripts that are.
RIGHT_TO_LEFT = frozenset(
    ["ar", "arc", "ckb", "dv", "fa", "he", "ks", "nqo", "ps", "sd", "syr", "ug", "ur", "yi"]
)
RIGHT_TO_LEFT_SCRIPTS = frozenset(
    ["adlm", "arab", "hebr", "mand", "mend", "nkoo", "rohg", "syrc", "thaa"]
)


def direction(lang: str) -> str:
    """``ltr`` or ``rtl``: by the script that a language tag names, else by the language."""
    language, *rest = lang.lower().split("-")
    script = next((part for part in rest if len(part) == 4 and part.isalpha()), None)
    if script is not None:
        return "rtl" if script in RIGHT_TO_LEFT_SCRIPTS else "ltr"
    return "rtl" if language in RIGHT_TO_LEFT else "ltr"


def words_in(lang: str, of: Literal["map", "page", "player"] = "map") -> dict[str, str]:
    """The words of map, page or player in a language; in English where there are none in it."""
    known = _words()
    return {**known[DEFAULT][of], **known.get(lang.lower().split("-")[0], {}).get(of, {})}


@cache
def _words() -> dict[str, dict[str, dict[str, str]]]:
    text = (resource("templates") / "words.yaml").read_text(encoding="utf-8")
    found: dict[str, dict[str, dict[str, str]]] = yaml.safe_load(text)
    return found
