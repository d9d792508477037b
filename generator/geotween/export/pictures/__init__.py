"""Pictures of a map: stills, sheets of several, and films for places without script or SVG."""
