"""Scenario files as trees that remember where each value was written."""
