"""Meshes from formulas and tables."""
