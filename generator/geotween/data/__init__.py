"""Geometry in: what formats hold, made valid, as polygon sets."""
