"""Controllers and sensors of the scenario as loops around the model."""
