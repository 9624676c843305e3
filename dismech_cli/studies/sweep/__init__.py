"""One scenario with many values, each run in a process of its own."""
