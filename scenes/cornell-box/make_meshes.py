"""Writes the Cornell box's surfaces as OBJ meshes, one file a surface, from the measured corners.

Corners in millimetres, as published by the Cornell University Program of Computer Graphics. Quads are wound so that they
face the inside of the room, and the blocks' faces outwards. Run it in this folder: python3 make_meshes.py
"""

SURFACES = {
    "floor": [[(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]],
    "ceiling": [[(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]],
    "back_wall": [[(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]],
    "right_wall": [[(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]],
    "left_wall": [[(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]],
    # Half a millimetre below the ceiling, so that the two do not coincide.
    "light": [[(343, 548.3, 227), (343, 548.3, 332), (213, 548.3, 332), (213, 548.3, 227)]],
    "short_block": [
        [(130, 165, 65), (82, 165, 225), (240, 165, 272), (290, 165, 114)],
        [(290, 0, 114), (290, 165, 114), (240, 165, 272), (240, 0, 272)],
        [(130, 0, 65), (130, 165, 65), (290, 165, 114), (290, 0, 114)],
        [(82, 0, 225), (82, 165, 225), (130, 165, 65), (130, 0, 65)],
        [(240, 0, 272), (240, 165, 272), (82, 165, 225), (82, 0, 225)],
    ],
    "tall_block": [
        [(423, 330, 247), (265, 330, 296), (314, 330, 456), (472, 330, 406)],
        [(423, 0, 247), (423, 330, 247), (472, 330, 406), (472, 0, 406)],
        [(472, 0, 406), (472, 330, 406), (314, 330, 456), (314, 0, 456)],
        [(314, 0, 456), (314, 330, 456), (265, 330, 296), (265, 0, 296)],
        [(265, 0, 296), (265, 330, 296), (423, 330, 247), (423, 0, 247)],
    ],
}

for name, quads in SURFACES.items():
    with open(f"meshes/{name}.obj", "w", encoding="ascii") as file:
        file.write("# Cornell box, measured data; written by make_meshes.py\n")
        for quad in quads:
            for x, y, z in quad:
                file.write(f"v {x} {y} {z}\n")
        for i in range(len(quads)):
            file.write("f " + " ".join(str(4 * i + corner) for corner in (1, 2, 3, 4)) + "\n")
