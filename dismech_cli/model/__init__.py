"""The semi-discrete system M a + r(q, v, t) = 0."""
