"""Who goes through many pairs or points: NumPy or compiled loops."""
