"""Functions of time: what a prescribed value, a load or an actuation follows."""
