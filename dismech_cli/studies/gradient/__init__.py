"""Numbers of a run differentiated by values of its scenario."""
