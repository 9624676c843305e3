"""Time: the loop that steps, writes and survives interruption."""
