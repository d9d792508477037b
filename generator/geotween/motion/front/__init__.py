"""The front motion: what changes in place, swept by a front that no polygon crosses."""
