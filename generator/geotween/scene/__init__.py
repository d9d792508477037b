"""What a scene file may say, and where in the file it said it."""
