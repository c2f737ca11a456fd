"""Results folders that are damaged behind their checksums.

    /usr/bin/python3 tests/fuzz/resealed_results.py SECONDS PROGRAM [SEED]

Makes a small results folder with finished runs, sums over seeds and a run that was killed, and for so many seconds
changes files in copies of it: values of JSON, bytes of tables, checkpoints and images. Checksums are made right again,
as no random change would leave them, so that what is behind them is reached. `run`, `run --list` and `verify` then
have to end by themselves within ten seconds, with exit code 0, 2 or 3. What does not is kept in found/ beside this
folder's copy, and the exit code is 1.
"""

import json
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import xxhash

SCENE = """<scene version="3.0.0">
  <sensor type="perspective"><transform name="to_world"><lookat origin="0, 1, 6" target="0, 1, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="2"/><translate z="-2"/></transform></shape>
  <shape type="rectangle">
    <transform name="to_world"><scale value="0.5"/><rotate x="1" angle="90"/><translate y="3"/></transform>
    <emitter type="area"><rgb name="radiance" value="8, 8, 6"/></emitter></shape>
</scene>
"""
EXPERIMENT = """passes = %d
seeds = 2
threads = 1
photons_per_pass = 50
decomposition = true
scenes = [{ path = "scene.xml", name = "walls", probes = { middle = [4, 4] } }]
[[method]]
integrator = "ppm"
[[method]]
integrator = "photonmapper"
"""
NUMBERS = [0, 1, -1, 255, 2**31 - 1, 2**31, 2**32, 2**63 - 1, 2**63, 2**64 - 1, -(2**63), 1e308, 5e-324, 0.1]
TEXTS = ["", "x", "x" * 1000, "a\x00b", "../../../etc/passwd", "/dev/zero", "\ud7ff", "\n", "=1+1", "iterations.csv", "."]


def checksum(data):
    return xxhash.xxh3_128_hexdigest(data)


def sealed_json(value):
    text = json.dumps(value, indent=2, ensure_ascii=False)[:-2]
    return f'{text},\n  "checksum": "{checksum(text.encode())}"\n}}\n'


def read_json(file):
    value = json.loads(file.read_text())
    value.pop("checksum", None)
    return value


def nodes(value, path=()):
    yield path
    for key, child in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from nodes(child, path + (key,))


def parent_of(value, path):
    for key in path[:-1]:
        value = value[key]
    return value


def change_json(value, chance):
    path = chance.choice([p for p in nodes(value) if p])
    parent, key = parent_of(value, path), path[-1]
    action = chance.randrange(6)
    if action == 0:
        del parent[key]
    elif action == 1 and isinstance(parent, dict):
        parent[chance.choice(TEXTS)] = parent[key]
    elif action == 2:
        other = chance.choice([p for p in nodes(value) if p])
        parent[key] = json.loads(json.dumps(parent_of(value, other)[other[-1]]))
    else:
        deep = []
        for _ in range(chance.choice([3, 300])):
            deep = [deep]
        parent[key] = chance.choice([None, True, [], {}, deep, chance.choice(NUMBERS), chance.choice(TEXTS)])


def change_bytes(data, chance):
    data = bytearray(data)
    for _ in range(chance.choice([1, 1, 2, 8])):
        at = chance.randrange(len(data) + 1)
        action = chance.randrange(5)
        if action == 0:
            del data[at:]
        elif action == 1:
            del data[at : at + chance.choice([1, 8, 100])]
        elif action == 2:
            data[at:at] = data[at : at + chance.choice([1, 8, 100])]
        elif action == 3:
            data[at : at + 8] = chance.choice([0, 1, 2**31, 2**40, 2**62, 2**64 - 1]).to_bytes(8, "little")
        elif at < len(data):
            data[at] = chance.randrange(256)
        if not data:
            break
    return bytes(data)


def resealed_image(data):
    """As write_sealed_exr() closes it, where the attributes are still there."""
    for name, digits in (("photonlab.bytes", 20), ("photonlab.checksum", 32)):
        at = data.find(name.encode() + b"\0string\0")
        if at < 0:
            return data
        at += len(name) + 12
        text = f"{len(data):020}".encode() if digits == 20 else b"0" * 32
        data = data[:at] + text + data[at + digits :]
    return data[:at] + checksum(data).encode() + data[at + 32 :]


def restamp(file, root):
    """Writes the file's size and hash where they are written down."""
    data = file.read_bytes()
    stamp = {"bytes": len(data), "hash": checksum(data)}
    if file.parent == root:
        description, name = root / "merged.json", file.name
    else:
        description = next(folder / "run.json" for folder in file.parents if folder.parent.name == "runs")
        name = file.relative_to(description.parent).as_posix()
    if not description.exists():
        return
    try:
        value = read_json(description)
        value["files"][name] = [stamp] if file.parent == root else stamp
    except (ValueError, KeyError, TypeError, AttributeError):
        return
    description.write_text(sealed_json(value))


def change(file, root, chance):
    if file.suffix == ".json":
        value = read_json(file)
        for _ in range(chance.choice([1, 1, 3])):
            if value:
                change_json(value, chance)
        if value:
            file.write_text(sealed_json(value), errors="surrogatepass")
    elif file.name == "checkpoint":
        data = change_bytes(file.read_bytes()[:-32], chance)
        file.write_bytes(data + checksum(data).encode())
    elif "ensembles" in file.parts:
        file.write_bytes(resealed_image(change_bytes(file.read_bytes(), chance)))
    else:
        file.write_bytes(change_bytes(file.read_bytes(), chance))
        restamp(file, root)


def make_whole(program, folder):
    """Three runs that are finished, and one that was killed at a checkpoint."""
    (folder / "scene.xml").write_text(SCENE)
    (folder / "e.toml").write_text(EXPERIMENT % 40)
    command = [program, "run", "e.toml", "-o", "whole", "--checkpoint-seconds", "0"]
    subprocess.run(command + ["--only", "*_seed-1"], cwd=folder, check=True, capture_output=True)
    subprocess.run(command + ["--only", "*_photonmapper_seed-2"], cwd=folder, check=True, capture_output=True)
    checkpoint = folder / "whole/runs/walls_ppm_seed-2/checkpoint"
    while not checkpoint.exists():
        process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None and not checkpoint.exists():
            time.sleep(0.001)
        process.send_signal(signal.SIGKILL)
        process.wait()
        if not checkpoint.exists():
            shutil.rmtree(checkpoint.parent)
    for lock in (folder / "whole").rglob("lock"):
        lock.unlink()


def try_once(program, folder):
    """What is wrong with the program's end, of each command that ends wrongly."""
    for words in (["verify", "copy"], ["run", "e.toml", "-o", "copy", "--list"], ["run", "e.toml", "-o", "copy"], ["verify", "copy"]):
        try:
            done = subprocess.run([program, *words], cwd=folder, capture_output=True, timeout=10, errors="replace")
        except subprocess.TimeoutExpired:
            return f"{' '.join(words)}: has not ended after ten seconds"
        if done.returncode not in (0, 2, 3) or "internal error" in done.stderr:
            return f"{' '.join(words)}: exit code {done.returncode}: {done.stderr[-400:]}"
    return None


def main():
    seconds, program = float(sys.argv[1]), str(Path(sys.argv[2]).resolve())
    chance = random.Random(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    found = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_whole(program, folder)
        files = sorted(f.relative_to(folder / "whole") for f in (folder / "whole").rglob("*") if f.is_file())
        end, tried = time.monotonic() + seconds, 0
        while time.monotonic() < end:
            shutil.rmtree(folder / "copy", ignore_errors=True)
            shutil.copytree(folder / "whole", folder / "copy")
            changed = chance.sample(files, chance.choice([1, 1, 2]))
            for file in changed:
                change(folder / "copy" / file, folder / "copy", chance)
            shutil.rmtree(folder / "before", ignore_errors=True)
            shutil.copytree(folder / "copy", folder / "before")
            fault = try_once(program, folder)
            tried += 1
            if fault:
                found += 1
                kept = Path("found") / f"results-{found}"
                shutil.rmtree(kept, ignore_errors=True)
                shutil.copytree(folder / "before", kept)
                print(f"{kept}: {', '.join(map(str, changed))}: {fault}", flush=True)
    print(f"{tried} folders, {found} found")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
