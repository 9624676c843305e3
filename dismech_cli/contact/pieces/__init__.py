"""Lines cut into pieces that face one feature each: a segment, a vertex, a triangle, a core."""
