"""Writes the lamp's glass shade as an OBJ mesh: a closed pear of revolution with a cavity. Run it in this folder:
python3 make_meshes.py

Centimetres, the axis is y, the origin is where the emitter's centre goes. Two closed surfaces bound the glass: the outer wall, and
the wall of the cavity, whose normals point into the cavity: out of the glass, as the outer wall's do. Each wall is the curve
r = a sin t (1 - c cos t), y = y0 + b cos t, t from 0 (top) to pi (bottom), with the curve's own normals, so that light refracts
as in round glass. The glass is about 3 cm thick at the sides and 6 at the bottom, where it focuses.
"""

from math import cos, hypot, pi, sin

OUTER = {"a": 25.0, "b": 34.0, "c": 0.25, "y0": 0.0}
CAVITY = {"a": 21.8, "b": 28.5, "c": 0.22, "y0": 1.0}
AROUND = 64  # segments around the axis
ALONG = 30   # segments from pole to pole


def curve(wall, t):
    """Point (r, y) of a wall and its unit normal away from the axis."""
    r = wall["a"] * sin(t) * (1 - wall["c"] * cos(t))
    y = wall["y0"] + wall["b"] * cos(t)
    dr = wall["a"] * (cos(t) - wall["c"] * cos(2 * t))
    dy = -wall["b"] * sin(t)
    length = hypot(dr, dy)
    return (r, y), (-dy / length, dr / length)


def write_wall(file, wall, first_vertex, sign):
    """Top pole, rings from top to bottom, bottom pole. sign = 1: normals away from the axis; -1: towards it."""
    points, normals = [], []
    for ring in range(ALONG + 1):
        (r, y), (normal_r, normal_y) = curve(wall, pi * ring / ALONG)
        if ring in (0, ALONG):
            points.append((0, y, 0))
            normals.append((0, sign if ring == 0 else -sign, 0))
            continue
        for segment in range(AROUND):
            angle = 2 * pi * segment / AROUND
            points.append((r * cos(angle), y, r * sin(angle)))
            normals.append((sign * normal_r * cos(angle), sign * normal_y, sign * normal_r * sin(angle)))

    def vertex(ring, segment):
        if ring == 0:
            return first_vertex
        if ring == ALONG:
            return first_vertex + len(points) - 1
        return first_vertex + 1 + (ring - 1) * AROUND + segment % AROUND

    for x, y, z in points:
        file.write(f"v {x:.5g} {y:.5g} {z:.5g}\n")
    for x, y, z in normals:
        file.write(f"vn {x:.5g} {y:.5g} {z:.5g}\n")
    for ring in range(ALONG):
        for segment in range(AROUND):
            face = [vertex(ring, segment), vertex(ring, segment + 1), vertex(ring + 1, segment + 1), vertex(ring + 1, segment)]
            face = list(dict.fromkeys(face))  # at the poles a triangle
            file.write("f " + " ".join(f"{i}//{i}" for i in face[::sign]) + "\n")
    return first_vertex + len(points)


with open("meshes/shade.obj", "w", encoding="ascii") as file:
    file.write("# A hollow glass pear: outer wall, then the cavity's wall; written by make_meshes.py\n")
    following = write_wall(file, OUTER, 1, 1)
    write_wall(file, CAVITY, following, -1)
