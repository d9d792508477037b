"""How the polygons of one step become those of the next: correspond, divide, match, interpolate."""
