"""Map furniture: what helps to read a map, computed once and drawn by SVG and page alike."""
