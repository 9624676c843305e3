"""Mesh files to meshes, each format behind one door."""
