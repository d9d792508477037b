"""Scenes shown while they are written: built anew when a file changes, in a page that follows."""
