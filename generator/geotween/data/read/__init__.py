"""Reading: the polygons that a scene names, out of its text or of files."""
