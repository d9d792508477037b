"""The story of a scene: what happened to its features, and the words for it."""
