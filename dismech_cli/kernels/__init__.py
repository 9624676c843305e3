"""One source of every formula, two speeds: NumPy batches and compiled loops."""
