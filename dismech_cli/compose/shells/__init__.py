"""Tables of the models of shells, and the edges that carry normals."""
