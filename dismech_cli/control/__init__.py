"""Controllers and sensors: what closes a loop around a model; all memory is explicit."""
