"""The page about events: its example is what the command prints, its messages are all there are."""

from __future__ import annotations

import re
from pathlib import Path

import yaml
from click.testing import CliRunner

from geotween.cli import main
from geotween.story.templates import FORMS, MESSAGES
from geotween.story.words import LANGUAGES

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "events.md").read_text(encoding="utf-8")


def test_the_example_is_what_the_command_prints() -> None:
    (scene, block) = re.findall(r"<!-- geotween events (\S+) -->\n```\n(.*?)```", PAGE, re.S)[0]
    printed = CliRunner().invoke(main, ["events", str(ROOT / scene)]).stdout
    assert block == printed


def test_every_message_is_told() -> None:
    rows = [line.split("|")[1] for line in PAGE.partition("| message |")[2].splitlines()[2:]]
    told = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    assert told == {name for name in MESSAGES if not name.startswith("all_")} | {"all_appeared"}
    assert all(f"`{form}`" in PAGE for form in FORMS)
    assert set(LANGUAGES) == {"de", "en"}


def test_the_examples_of_words_can_be_read() -> None:
    blocks = re.findall(r"```yaml\n(.*?)```", PAGE, re.S)
    assert [sorted(yaml.safe_load(block)) for block in blocks] == [
        ["story"], ["story"], ["areas", "dates", "noun", "says"],
    ]  # fmt: skip
