"""From a tree to a valid scenario, every fault at its place."""
