"""Writes the checkered floor's texture: 2 x 2 checks, 8-bit sRGB PNG. Run it in this folder: python3 make_texture.py"""

import struct
import zlib

SIZE = 64  # pixels a side
LIGHT, DARK = (205, 198, 186), (104, 122, 112)  # sRGB


def write_png(name, rows):
    """`rows`: a list of rows of (red, green, blue), 0 to 255."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    pixels = b"".join(b"\0" + bytes(channel for pixel in row for channel in pixel) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    with open(name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0"))
        file.write(chunk(b"IDAT", zlib.compress(pixels, 9)) + chunk(b"IEND", b""))


half = SIZE // 2
write_png("textures/checks.png", [[LIGHT if (x < half) == (y < half) else DARK for x in range(SIZE)] for y in range(SIZE)])
