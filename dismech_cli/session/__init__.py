"""One run as a user knows it: load, check, conduct, judge; what commands and Python users call."""
