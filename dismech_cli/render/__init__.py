"""Pictures from results; reads result files only."""
