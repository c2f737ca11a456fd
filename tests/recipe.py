#!/usr/bin/env python3
"""tests/recipe.py BUILD: follows the recipe of docs/adding.md to the letter in a copy: writes its file, changes its line of CMake, and
runs its commands. Fails where something does not compile, run or agree.

Only its first command is not run as it stands, since it would build all of the program again: the file and the list of integrators are
compiled as CMake says in the copy, and linked with what BUILD, a finished build of the same sources, has of the rest.
"""

import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
OBJECTS = "src/integrators/CMakeFiles/photonlab_integrators.dir"
PROGRAM = "src/app/photonlab"
LARGEST_DIFFERENCE = 1e-6    # RMSE of radiance


def blocks_of(text: str) -> dict[str, str]:
    """{language: code} of the recipe's blocks, one of each."""
    recipe = text[text.index("## An integrator, from nothing"):]
    return dict(re.findall(r"```(\w+)\n(.*?)```", recipe, re.DOTALL))


def apply(copy: pathlib.Path, recipe: str, blocks: dict[str, str]) -> str:
    """Does what the recipe says in the copy; returns the name of its file, without .cpp."""
    name = re.search(r"`src/integrators/(\w+)\.cpp`:\n", recipe)[1]
    (copy / f"src/integrators/{name}.cpp").write_text(blocks["cpp"])
    listing = copy / "src/integrators/CMakeLists.txt"
    changed, count = re.subn(r"(?m)^set\(integrators .*\)\n", blocks["cmake"], listing.read_text())
    assert count == 1 and changed != listing.read_text(), "the recipe's line of CMake is not in place of another"
    listing.write_text(changed)
    return name


def run(*command: object, cwd: pathlib.Path) -> str:
    done = subprocess.run([str(part) for part in command], cwd=cwd, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{shlex.join(str(part) for part in command)}\n{done.stdout}{done.stderr}")
    return done.stdout


def build(copy: pathlib.Path, finished: pathlib.Path, name: str) -> None:
    """Leaves the program where the recipe's commands have it."""
    fresh, target = copy / "objects", copy / "build/release" / PROGRAM
    run("cmake", "-S", copy, "-B", fresh, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF",
        "-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON", cwd=copy)
    objects = [f"{OBJECTS}/{file}.cpp.o" for file in [name, "registry"]]
    run("cmake", "--build", fresh, "--target", *objects, cwd=copy)
    link = run("ninja", "-t", "commands", PROGRAM, cwd=finished).strip().split("\n")[-1]
    target.parent.mkdir(parents=True)
    # Before the libraries, which then have nothing to add of the list.
    ours = " ".join(shlex.quote(str(fresh / file)) for file in objects)
    changed = link.replace(f"-o {PROGRAM} ", f"-o {shlex.quote(str(target))} {ours} ")
    assert changed != link, link
    run("sh", "-c", changed, cwd=finished)


def main(finished: pathlib.Path) -> None:
    text = (ROOT / "docs/adding.md").read_text()
    blocks = blocks_of(text)
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder)
        shutil.copytree(ROOT / "src", copy / "src")
        shutil.copy(ROOT / "CMakeLists.txt", copy)
        (copy / "scenes").symlink_to(ROOT / "scenes")
        name = apply(copy, text, blocks)
        first, *commands = blocks["sh"].strip().split("\n")
        assert first.startswith("cmake --build"), first
        build(copy, finished.resolve(), name)
        said = run("sh", "-e", "-c", "\n".join(commands), cwd=copy)
        difference = float(re.search(r"(?m)^rmse\s+(\S+)", said)[1])
        mean = float(re.search(r"(?m)^bias\s+(\S+)", said)[1])
        assert difference < LARGEST_DIFFERENCE and abs(mean) < LARGEST_DIFFERENCE, said
    print(f"The recipe of docs/adding.md compiles and runs; it differs from ppm by an RMSE of {difference:g}.")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
