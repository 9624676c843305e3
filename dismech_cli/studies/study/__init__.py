"""The cheapest setting for an accuracy, by search."""
