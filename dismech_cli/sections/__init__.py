"""From material and shape to stiffness and mass."""
