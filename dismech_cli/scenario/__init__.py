"""What the user said: schema, loader, units. Knows nothing of the numerics."""
