"""The globe and the plane: coordinate reference systems and projections."""
