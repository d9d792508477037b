"""``python -m geotween``."""

from geotween.cli import main

main(prog_name="geotween")
