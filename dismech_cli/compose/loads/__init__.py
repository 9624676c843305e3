"""Forces of the scenario as terms of the model."""
