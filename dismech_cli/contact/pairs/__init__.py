"""Bodies that touch each other: finds them and remembers which."""
