"""Contact and friction: lines of bodies against obstacles and against each other."""
