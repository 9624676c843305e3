"""What touches what: pure functions of index arrays."""
