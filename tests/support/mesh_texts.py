"""Small mesh files as texts."""

from __future__ import annotations

# Two triangles with a boundary curve in a group, a free curve as a rope, and sparse node tags.
MSH41 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
4
0 7 "tip"
1 5 "rope"
1 6 "clamp line"
2 1 "bell"
$EndPhysicalNames
$Entities
1 3 1 0
1 0 0 -1 1 7
1 0 0 0 1 0 0 1 6 0
2 0 0 -1 0 0 0 2 5 -8 2 1 1
3 0 0 0 0 0 0 0 0
1 0 0 0 1 1 0 1 1 1 1
$EndEntities
$Nodes
2 6 1 600
0 1 0 1
600
0 0 -1
2 1 0 5
1
2
3
40
50
0 0 0
1 0 0
1 1 0
0 1 0
0 0 -0.5
$EndNodes
$Elements
5 7 1 7
0 1 15 1
1 600
1 1 1 1
2 1 2
1 2 1 2
3 1 50
4 50 600
1 3 1 1
5 2 3
2 1 2 2
6 1 2 3
7 1 3 40
$EndElements
"""


MSH22 = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 5 "rope"
2 1 "bell"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 1 1 0
9 0 1 0
5 0 0 -1
$EndNodes
$Elements
4
1 1 2 5 1 1 5
2 2 2 1 1 1 2 3
3 2 2 1 1 1 3 9
4 2 2 8 1 1 3 9
$EndElements
"""


BELL = """# a canopy with a rope
mtllib bell.mtl
o bell
v 0 0 0
v 1 0 0 1.0
v 1 1 0 0.5 0.5 0.5
v 0 1 0
vt 0 0
vn 0 0 1
usemtl silk
g canopy top
f 1/1/1 2/1/1 3/1/1
f -4//1 -2//1 -1//1
g rope
v 0 0 -1
v 0 0 -2
l 1 5 6
p 6
"""


HYBRID = """# one rope under two triangles
*Edges
1, 2

*Nodes   # metres
0, 0, 0
1e-1, 0, 0
0.2, 0.1, 0
+0.2, -.1, 0
0.3, 0, 0
*Triangles
2, 4, 3
3, 4, 5
"""
