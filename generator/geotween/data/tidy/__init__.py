"""Tidying: valid, disjoint, clean and simple polygon sets."""
