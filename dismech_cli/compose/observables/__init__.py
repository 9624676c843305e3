"""What a run shows of itself: fields and probes."""
