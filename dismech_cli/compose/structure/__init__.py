"""What the scene needs, what holds it, and how its DOFs are numbered."""
