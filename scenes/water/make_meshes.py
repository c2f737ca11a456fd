"""Writes the pool's wavy surface (OBJ) and its floor tiles (PNG). Run it in this folder: python3 make_meshes.py

Metres, y is up, the water's mean level is y = 0 here. The height is a sum of five sine waves and the vertex normals are its
gradient's, so the surface refracts as the smooth waves do. The waves' curvatures a k^2 are all alike and set from the optics: a
crest of curvature K focuses light from above at the depth n / ((n - 1) K), and K here is 1.5 times the standard deviation of the
sum's curvature, so that the stronger crests focus at the floor.
"""

import struct
import zlib
from math import cos, hypot, pi, radians, sin, sqrt

INDEX = 1.33
DEPTH = 1.5       # of the water, from its mean level to the floor
HALF_WIDTH = 2.1  # of the mesh; the pool's is 2, and its walls are solid
CELLS = 60        # a side
WAVES = [(1.10, 20, 0.3), (0.95, 95, 1.9), (0.82, 155, 4.0), (0.73, 58, 5.1), (0.64, 128, 2.6)]  # length, degrees, phase

focusing_curvature = INDEX / ((INDEX - 1) * DEPTH)
curvature = focusing_curvature / (1.5 * sqrt(len(WAVES) / 2))  # of each wave: the sum's variance is that of five sines


def wave_terms(x, z):
    for length, degrees, phase in WAVES:
        number = 2 * pi / length
        kx, kz = number * cos(radians(degrees)), number * sin(radians(degrees))
        yield curvature / number**2, kx, kz, kx * x + kz * z + phase


def height(x, z):
    return sum(amplitude * sin(angle) for amplitude, _, _, angle in wave_terms(x, z))


def slope(x, z):
    terms = list(wave_terms(x, z))
    return sum(a * kx * cos(angle) for a, kx, _, angle in terms), sum(a * kz * cos(angle) for a, _, kz, angle in terms)


def write_surface(name):
    steps = [HALF_WIDTH * (2 * i / CELLS - 1) for i in range(CELLS + 1)]
    with open(name, "w", encoding="ascii") as file:
        file.write("# Waves, normals up; written by make_meshes.py\n")
        for z in steps:
            for x in steps:
                file.write(f"v {x:.4g} {height(x, z):.4g} {z:.4g}\n")
        for z in steps:
            for x in steps:
                slope_x, slope_z = slope(x, z)
                length = hypot(slope_x, 1, slope_z)
                file.write(f"vn {-slope_x / length:.4f} {1 / length:.4f} {-slope_z / length:.4f}\n")
        for row in range(CELLS):
            for column in range(CELLS):
                first = row * (CELLS + 1) + column + 1
                face = [first, first + CELLS + 1, first + CELLS + 2, first + 1]
                file.write("f " + " ".join(f"{i}//{i}" for i in face) + "\n")


def write_png(name, rows):
    """`rows`: a list of rows of (red, green, blue), 0 to 255."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    pixels = b"".join(b"\0" + bytes(channel for pixel in row for channel in pixel) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    with open(name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0"))
        file.write(chunk(b"IDAT", zlib.compress(pixels, 9)) + chunk(b"IEND", b""))


def tile_color(x, y):
    """2 x 2 tiles of 32 pixels in two near tones of sRGB, with joints of 2 pixels."""
    if x % 32 in (0, 31) or y % 32 in (0, 31):
        return (150, 172, 178)
    return (176, 205, 211) if (x < 32) == (y < 32) else (166, 197, 207)


write_surface("meshes/surface.obj")
write_png("textures/tiles.png", [[tile_color(x, y) for x in range(64)] for y in range(64)])
