"""Contact and friction of a scene."""
