"""Points of contact: what each adds to energy, force and stiffness."""
