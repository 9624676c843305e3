"""One pure energy kernel per file."""
