"""Elastic energies of rods, shells and welds, driven where the scene is actuated."""
