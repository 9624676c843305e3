"""The only place that knows both the scenario and the model."""
