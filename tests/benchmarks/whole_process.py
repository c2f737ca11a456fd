"""Times a fixed piece of work as whole processes: both Cornell boxes, one thread and two.

Start, loading, hit points and writing the image are in it, as they are for whoever waits for it. The work is that of
docs/performance.md: 256 x 256, one sample a pixel, 16 passes of 100,000 light paths, radius 5.55, direct light sampled
once a pass, maximum depth 32. CPU seconds and the largest memory come from the operating system (wait4). With several
programs, their runs alternate, so that what else the machine does hits all of them.

    /usr/bin/python3 tests/benchmarks/whole_process.py build/release/src/app/photonlab [ANOTHER ...] [--runs 5]
"""

import argparse
import os
import re
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

SCENES = Path(__file__).resolve().parents[2] / "scenes"
BOXES = ("cornell-box", "cornell-spheres")
WORK = ("--resolution 256x256 --passes 16 --photons 100000 --radius 5.55 --max-depth 32").split()
COLUMNS = "{:<16} {:>7} {:>10} {:>10} {:>10} {:>10} {:>10}  {}"


def run(command):
    """Seconds, CPU seconds and largest memory (bytes) of one process, and what it printed."""
    began = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        printed = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command)}: exit code {process.returncode}")
    return time.perf_counter() - began, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, printed


def render(program, box, output, options):
    scene = SCENES / box / "scene.xml"
    return run([program, "render", str(scene), "-o", str(output), *options])


def whole_work(programs, runs, output):
    print(COLUMNS.format("scene", "threads", "seconds", "fastest", "CPU s", "least", "peak MiB", "program"))
    for box in BOXES:
        for threads in (1, 2):
            measured = {program: [] for program in programs}
            for _ in range(runs):
                for program in programs:
                    measured[program].append(render(program, box, output, [*WORK, "--threads", str(threads)])[:3])
            for program, figures in measured.items():
                seconds, cpu, peak = zip(*figures)
                print(COLUMNS.format(box, threads, f"{statistics.median(seconds):.3f}", f"{min(seconds):.3f}",
                                     f"{statistics.median(cpu):.3f}", f"{min(cpu):.3f}", f"{max(peak) / 2**20:.1f}",
                                     program))


def bytes_each(program, box, output):
    """Peak memory a photon and a hit point: by how much it grows with more of either."""
    def peak(resolution, samples, paths):
        _, _, memory, printed = render(program, box, output, [
            "--resolution", f"{resolution}x{resolution}", "--samples-per-pixel", str(samples), "--passes", "2",
            "--photons", str(paths), "--radius", "1", "--max-depth", "32", "--threads", "1"])
        photons = int(re.search(r"(\d+) stored", printed).group(1)) / 2
        hit_points = int(re.search(r"(\d+) hit points", printed).group(1))
        return memory, photons, hit_points

    few, many = peak(64, 1, 200_000), peak(64, 1, 1_000_000)
    a_photon = (many[0] - few[0]) / (many[1] - few[1])
    few, many = peak(256, 4, 2_000), peak(256, 16, 2_000)
    a_hit_point = (many[0] - few[0]) / (many[2] - few[2])
    return a_photon, a_hit_point


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("programs", nargs="+", metavar="PROGRAM", help="photonlab, built for release")
    parser.add_argument("--runs", type=int, default=5, help="of each, whose median and least are shown [5]")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "image.exr"
        whole_work(arguments.programs, arguments.runs, output)
        print()
        for program in arguments.programs:
            for box in BOXES:
                a_photon, a_hit_point = bytes_each(program, box, output)
                print(f"{box:<16} peak memory grows by {a_photon:.1f} bytes a photon, {a_hit_point:.1f} a hit point"
                      f"  {program}")


if __name__ == "__main__":
    main()
