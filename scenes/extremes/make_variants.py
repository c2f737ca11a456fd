"""Writes variants/, the scenes of experiments/extremes*.toml, and meshes/, the slivers. Run it in this folder:
python3 make_variants.py

A variant is a scene of this folder with other values for its <default>s. Its name is an axis and a value: unit-1e-06 is the furnace
whose half edge is 1e-6 scene units. Every scene's answer is a number that README.md gives.
"""

from math import sqrt
from pathlib import Path

UNITS = [1e-100, 1e-50, 1e-20, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e20, 1e50, 1e100]
OFFSET_RADIUS = 0.017    # no power of two, which doubles hold as exactly 10^14 scene sizes away
OFFSETS = [1.0, 1e2, 1e4, 1e6, 1e8, 1e9, 1e10, 1e11, 2e11, 4e11]        # in sizes of the scene; from 4.5e11 on they are refused
LIGHTS = [1e-45, 1e-44, 1e-43, 1e-42, 1e-40, 1e-35, 1e-30, 1e-20, 1e-10, 1.0, 1e10, 1e20, 1e30, 1e37, 1e38]
RADII = [2.0 ** -power for power in (23, 22, 21, 20, 18, 15, 12, 9, 6)]    # in sizes of the scene; floats hold them exactly
INDICES = [1.0, 1.0000001, 1.0001, 1.1, 1.33, 1.5, 1.8, 2.0, 2.4, 3.0, 4.0]
THICKNESSES = [1e-8, 1e-7, 5e-7, 1e-6, 1.5e-6, 2e-6, 2.5e-6, 3e-6, 5e-6, 1e-5, 1e-4, 1e-3, 1e-2]    # in sizes of the scene
RATIOS = [1e1, 1e2, 1e3, 1e4, 6e4, 1e5, 2e5, 4e5, 6e5, 1e6, 2e6, 5e6, 1e7]         # length of a sliver by its width

CENTRE = (0.11, -0.23, 0.17)    # of the tilted floor
LENGTH = 0.6
STRIPS = 40


def combined(*terms):
    """Sum of factor times vector."""
    return tuple(sum(factor * vector[axis] for factor, vector in terms) for axis in range(3))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit_vector(vector):
    length = sqrt(sum(x * x for x in vector))
    return tuple(x / length for x in vector)


ACROSS = unit_vector((0.6, 0.5, -0.3))
NORMAL = unit_vector(cross(ACROSS, (0.1, 0.7, 0.4)))
ALONG = cross(NORMAL, ACROSS)


def write_slivers(file, ratio):
    """Strips of two triangles each, side by side, LENGTH long and LENGTH / ratio wide."""
    width = min(LENGTH / ratio, LENGTH / STRIPS)
    lines = [f"# {STRIPS} strips, {LENGTH} long and {width:g} wide: make_variants.py"]
    for strip in range(STRIPS + 1):
        for end in (-0.5, 0.5):
            corner = combined((1, CENTRE), ((strip - STRIPS / 2 - 0.25) * width, ACROSS), (end * LENGTH, ALONG))
            lines.append("v " + " ".join(f"{x:.17g}" for x in corner))
    for strip in range(STRIPS):
        low = 2 * strip + 1
        lines += [f"f {low} {low + 2} {low + 1}", f"f {low + 1} {low + 2} {low + 3}"]
    file.write_text("\n".join(lines) + "\n")
    return width


def write_foot(axis, value, radius, offset=(0.0, 0.0, 0.0)):
    def moved(*point):
        return ", ".join(repr(x + by) for x, by in zip(point, offset))
    write_variant(axis, value, "foot", floor=moved(0.0, -0.25, 0.0), foot=moved(0.3, -0.25, 0.2),
                  lamp=moved(0.3, -0.25 + 2 * radius, 0.2), camera=moved(0.3, -0.25 + radius, 0.2),
                  speck=moved(-0.25, 0.2490234375, -0.25), intensity=repr(4 * radius * radius))


def write_variant(axis, value, scene, **defaults):
    values = "".join(f'    <default name="{name}" value="{text}"/>\n' for name, text in defaults.items())
    (Path("variants") / f"{axis}-{value:.8g}.xml").write_text(
        f'<scene version="3.0.0">\n{values}    <include filename="../{scene}.xml"/>\n</scene>\n')


def main():
    for folder in ["variants", "meshes"]:
        Path(folder).mkdir(exist_ok=True)
        for file in Path(folder).iterdir():
            file.unlink()
    for unit in UNITS:
        write_variant("unit", unit, "furnace", unit=f"{unit:g}")
    for offset in OFFSETS:
        write_foot("offset", offset, OFFSET_RADIUS, offset=(offset, -0.7 * offset, 0.3 * offset))
    for light in LIGHTS:
        write_variant("light", light, "furnace", light=f"{light:g}")
    for radius in RADII:
        write_foot("radius", radius, radius)
    for index in INDICES:
        write_variant("index", index, "glass", shape="ball", index=f"{index:.8g}")
    for thickness in THICKNESSES:
        write_variant("thickness", thickness, "glass", shape="sheet", half_thickness=f"{4 * thickness:.6g}")
    for ratio in RATIOS:
        name = f"meshes/slivers-{ratio:.8g}.obj"
        width = write_slivers(Path(name), ratio)
        # As wide as three strips on either side, and never so wide that the light falls off.
        half = min(3 * width, 1e-3)
        write_variant("slivers", ratio, "slivers", mesh=f"../{name}", fov=f"{half / 0.2 * 114.591559:.6g}")


if __name__ == "__main__":
    main()
