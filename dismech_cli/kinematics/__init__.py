"""Positions, angles and the frames that are carried along with them."""
