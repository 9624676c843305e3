"""The state that a run starts from."""
