"""Geometry as arrays: read, generate, connect, validate."""
