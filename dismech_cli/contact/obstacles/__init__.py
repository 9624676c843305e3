"""Rigid obstacles: their shapes and poses, and the lines that touch them."""
