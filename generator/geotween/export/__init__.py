"""Keyframes out: SVG, page and gallery."""
