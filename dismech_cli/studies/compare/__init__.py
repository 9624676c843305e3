"""Two runs, field by field."""
