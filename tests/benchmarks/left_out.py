"""What a scene that requires less saves: the Cornell box beside itself with one thing more in it that no light can reach.

A mirror sphere, a measured material or a texture is put inside the tall block, which is closed. So the light and the hit
points are the same, but the program can no longer leave out what only such things need: branches and views, PM's map of
caustics, directions to the camera, coordinates and look-ups of textures. CPU seconds of whole processes and their largest
memory, runs alternating.

    (cd scenes/merl && /usr/bin/python3 make_table.py)
    /usr/bin/python3 tests/benchmarks/left_out.py build/release/src/app/photonlab [--runs 5]
"""

import argparse
import statistics
import tempfile
from pathlib import Path

import whole_process

SCENES = whole_process.SCENES
HIDDEN = """<shape type="sphere"><point name="center" x="368" y="165" z="351"/><float name="radius" value="{radius}"/>{bsdf}</shape>"""
THINGS = {
    "nothing": "",
    "a mirror": '<bsdf type="conductor"><string name="material" value="none"/></bsdf>',
    "a measured material": f'<bsdf type="merl"><string name="filename" value="{SCENES}/merl/table.binary"/></bsdf>',
    "a texture": '<bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" '
                 f'value="{SCENES}/glass-sphere/textures/checks.png"/></texture></bsdf>',
}
WORK = "--resolution 256x256 --passes 16 --photons 100000 --max-depth 32 --threads 1".split()
METHODS = {"ppm": ["--radius", "5.55"], "photonmapper, nearest": ["--integrator", "photonmapper", "--mode", "nearest"]}
COLUMNS = "{:<22} {:<20} {:>8} {:>8} {:>9}"


def write_scene(folder, bsdf):
    """The Cornell box with a sphere in the tall block, of that material or, without one, of the default."""
    box = SCENES / "cornell-box"
    text = (box / "scene.xml").read_text(encoding="utf-8").replace('value="meshes/', f'value="{box}/meshes/')
    # The sphere is there in every variant, so that Embree has the same to do.
    sphere = HIDDEN.format(radius=20, bsdf=bsdf or '<bsdf type="diffuse"/>')
    scene = folder / "scene.xml"
    scene.write_text(text.replace("</scene>", f"    {sphere}\n</scene>"), encoding="utf-8")
    return scene


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", metavar="PROGRAM", help="photonlab, built for release")
    parser.add_argument("--runs", type=int, default=5, help="of each, whose median and least are shown [5]")
    arguments = parser.parse_args()
    print(COLUMNS.format("method", "hidden in the block", "CPU s", "least", "peak MiB"))
    with tempfile.TemporaryDirectory() as temporary:
        scenes = {}
        for place, (thing, bsdf) in enumerate(THINGS.items()):
            folder = Path(temporary) / str(place)
            folder.mkdir()
            scenes[thing] = write_scene(folder, bsdf)
        for method, options in METHODS.items():
            measured = {thing: [] for thing in scenes}
            for _ in range(arguments.runs):
                for thing, scene in scenes.items():
                    _, cpu, peak, _ = whole_process.run([
                        arguments.program, "render", str(scene), "-o", str(Path(temporary) / "image.exr"), *WORK, *options])
                    measured[thing].append((cpu, peak))
            for thing, figures in measured.items():
                cpu, peak = zip(*figures)
                print(COLUMNS.format(method, thing, f"{statistics.median(cpu):.3f}", f"{min(cpu):.3f}", f"{max(peak) / 2**20:.1f}"))


if __name__ == "__main__":
    main()
