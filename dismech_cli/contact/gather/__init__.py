"""What touches at a trial point, and sums over it to the nodes of the model."""
