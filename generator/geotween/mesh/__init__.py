"""Triangle meshes of polygons."""
