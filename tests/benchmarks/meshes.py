"""Scenes of as many triangles as people's own: the Cornell box with two boulders in place of its blocks.

A boulder is a sphere whose radius waves over nine octaves, with normals at its vertices and texture coordinates. Nine tenths
of the triangles are a diffuse one under a texture of checks, one tenth a smaller one of glass. What a scene of N triangles
costs is so measured with the box's walls and light, and with what real meshes have.

    /usr/bin/python3 tests/benchmarks/meshes.py results/meshes --triangles 10000,1000000 --formats ply,scan,obj

leaves FOLDER/FORMAT-N.xml and its meshes: as binary PLY (29 bytes a triangle), as scanners leave it, without normals,
coordinates and texture (19), and as OBJ (103). `loading.cpp` beside this file times reading, placing and building them.
"""

import argparse
import re
from pathlib import Path

import numpy

SCENES = Path(__file__).resolve().parents[2] / "scenes"
OCTAVES = 9
BOULDERS = {"diffuse": (0.9, (190, 130, 330), 120), "glass": (0.1, (400, 90, 180), 75)}    # share, centre, radius
MATERIALS = {
    "diffuse": f'<bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" '
               f'value="{SCENES}/glass-sphere/textures/checks.png"/></texture></bsdf>',
    "glass": '<bsdf type="dielectric"/>',
}


def boulder(triangles, centre, radius, seed):
    """Positions, normals, texture coordinates and triangles: rows from pole to pole, closed by a seam."""
    rows = max(4, round((triangles / 4) ** 0.5))
    v, u = numpy.meshgrid(numpy.linspace(0, 1, rows + 1), numpy.linspace(0, 1, 2 * rows + 1), indexing="ij")
    polar, around = numpy.pi * v, 2 * numpy.pi * u
    unit = numpy.stack([numpy.sin(polar) * numpy.cos(around), numpy.cos(polar), numpy.sin(polar) * numpy.sin(around)], axis=-1)
    unit[:, -1] = unit[:, 0]    # the seam, to the bit
    unit[0], unit[-1] = (0, 1, 0), (0, -1, 0)
    random = numpy.random.default_rng(seed)
    height = numpy.zeros(u.shape)
    for octave in range(OCTAVES):
        for _ in range(3):
            direction = random.normal(size=3)
            direction *= 3 * 2 ** octave / numpy.linalg.norm(direction)
            height += 0.08 * 0.5 ** octave * numpy.sin(unit @ direction + random.uniform(0, 2 * numpy.pi))
    positions = numpy.asarray(centre) + radius * (1 + height)[..., None] * unit
    corner = numpy.arange(rows * 2 * rows, dtype=numpy.int32)
    corner += corner // (2 * rows)    # a row has one vertex more than quadrilaterals
    below = corner + 2 * rows + 1
    upper, lower = numpy.stack([corner, corner + 1, below + 1], 1), numpy.stack([corner, below + 1, below], 1)
    faces = numpy.concatenate([upper[2 * rows:], lower[:-2 * rows]])    # at the poles, half of them have no area
    return positions.reshape(-1, 3), normals_of(positions), numpy.stack([u, v], -1).reshape(-1, 2), faces


def normals_of(positions):
    """Unit normals by central differences along rows and columns; straight up and down at the poles."""
    wrapped = numpy.concatenate([positions[:, -2:-1], positions, positions[:, 1:2]], axis=1)
    normals = numpy.cross(wrapped[:, 2:] - wrapped[:, :-2], numpy.gradient(positions, axis=0))
    normals[0], normals[-1] = (0, 1, 0), (0, -1, 0)
    return (normals / numpy.linalg.norm(normals, axis=-1, keepdims=True)).reshape(-1, 3)


def write_ply(file, positions, normals, coordinates, faces):
    write_polygons(file, "x y z nx ny nz u v", numpy.concatenate([positions, normals, coordinates], axis=1), faces)


def write_scan(file, positions, _normals, _coordinates, faces):
    write_polygons(file, "x y z", positions, faces)


def write_polygons(file, properties, vertices, faces):
    polygons = numpy.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    polygons["count"], polygons["corners"] = 3, faces
    with open(file, "wb") as stream:
        names = "".join(f"property float {name}\n" for name in properties.split())
        stream.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{names}element face {len(faces)}\n"
                     "property list uchar int vertex_indices\nend_header\n".encode())
        vertices.astype("<f4").tofile(stream)
        polygons.tofile(stream)


def write_obj(file, positions, normals, coordinates, faces):
    with open(file, "w", encoding="ascii") as stream:
        for line, values in [("v %.7g %.7g %.7g\n", positions), ("vt %.7g %.7g\n", coordinates), ("vn %.6f %.6f %.6f\n", normals)]:
            stream.writelines(line % tuple(value) for value in values.tolist())
        stream.writelines("f %d/%d/%d %d/%d/%d %d/%d/%d\n" % (a, a, a, b, b, b, c, c, c) for a, b, c in (faces + 1).tolist())


WRITERS = {"ply": ("ply", write_ply), "scan": ("ply", write_scan), "obj": ("obj", write_obj)}    # type of shape, writer


def write_scene(folder, triangles, form):
    """The scene file's path."""
    box = SCENES / "cornell-box"
    text = (box / "scene.xml").read_text(encoding="utf-8").replace('value="meshes/', f'value="{box}/meshes/')
    text = re.sub(r'    <shape type="obj" id="(short|tall)_block">.*?</shape>\n', "", text, flags=re.DOTALL)
    shapes = ""
    kind, write = WRITERS[form]
    for seed, (name, (share, centre, radius)) in enumerate(BOULDERS.items()):
        mesh = folder / f"{form}-{triangles}-{name}.{kind}"
        write(mesh, *boulder(share * triangles, centre, radius, seed))
        material = '<bsdf type="diffuse"/>' if (form, name) == ("scan", "diffuse") else MATERIALS[name]
        flip = '<boolean name="flip_tex_coords" value="false"/>' if kind == "obj" else ""
        shapes += f'    <shape type="{kind}"><string name="filename" value="{mesh.name}"/>{flip}{material}</shape>\n'
    scene = folder / f"{form}-{triangles}.xml"
    scene.write_text(text.replace("</scene>", f"{shapes}</scene>"), encoding="utf-8")
    return scene


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", metavar="FOLDER", type=Path)
    parser.add_argument("--triangles", default="10000,1000000", help="how many, with commas between [10000,1000000]")
    parser.add_argument("--formats", default="ply", help=f"of {', '.join(WRITERS)} [ply]")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    for form in arguments.formats.split(","):
        for triangles in map(int, arguments.triangles.split(",")):
            print(write_scene(arguments.folder, triangles, form), flush=True)


if __name__ == "__main__":
    main()
