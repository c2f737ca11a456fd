"""Writes the metal ring of the mirror-sphere scene as an OBJ mesh. Run it in this folder: python3 make_meshes.py

A ring of rectangular section around the y axis, in centimetres. Inner and outer wall are cylinders with the cylinder's own
normals, so that the caustic is the one of a round ring and not of its facets; the four rims are creases, where each side has
its own normal. The ring reaches below the floor, so that neither light nor a seam passes under it.
"""

from math import cos, pi, sin

INNER_RADIUS, OUTER_RADIUS = 12.0, 12.8
BOTTOM, TOP = -0.5, 5.0
SEGMENTS = 96

# The section, counterclockwise as seen with r to the right and y up: (r, y) of start and end of a side, and its normal.
SIDES = [
    ((INNER_RADIUS, TOP), (INNER_RADIUS, BOTTOM), (-1, 0)),
    ((INNER_RADIUS, BOTTOM), (OUTER_RADIUS, BOTTOM), (0, -1)),
    ((OUTER_RADIUS, BOTTOM), (OUTER_RADIUS, TOP), (1, 0)),
    ((OUTER_RADIUS, TOP), (INNER_RADIUS, TOP), (0, 1)),
]
CORNERS = [start for start, _, _ in SIDES]


def around(r, y, segment):
    angle = 2 * pi * segment / SEGMENTS
    return f"{r * cos(angle):.6g} {y:.6g} {r * sin(angle):.6g}"


with open("meshes/ring.obj", "w", encoding="ascii") as file:
    file.write("# A ring with smooth walls; written by make_meshes.py\n")
    for segment in range(SEGMENTS):
        for r, y in CORNERS:
            file.write(f"v {around(r, y, segment)}\n")
    for segment in range(SEGMENTS):
        for _, _, (normal_r, normal_y) in SIDES:
            file.write(f"vn {around(normal_r, normal_y, segment)}\n")
    for segment in range(SEGMENTS):
        following = (segment + 1) % SEGMENTS
        for side in range(4):
            end = (side + 1) % 4
            corners = [(segment, side), (segment, end), (following, end), (following, side)]
            file.write("f " + " ".join(f"{4 * s + c + 1}//{4 * s + side + 1}" for s, c in corners) + "\n")
