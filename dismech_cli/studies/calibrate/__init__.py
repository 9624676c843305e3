"""Values of a scenario fitted to measured curves."""
