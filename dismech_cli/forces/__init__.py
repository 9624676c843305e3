"""External forces, one per file."""
