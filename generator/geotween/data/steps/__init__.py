"""Steps: out of times and places, files with times, or points."""
