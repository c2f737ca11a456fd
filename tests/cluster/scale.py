#!/usr/bin/python3
"""scale.py PHOTONLAB FOLDER [--made 100 1000 10000] [--replayed 100000] [-o TABLE.csv]: what a study of many tiny runs costs.

Studies of so many runs (16 x 16 pixels, 2 passes, four methods a seed) are made, or replayed: the records of one seed written
again under the names and keys of all. Then each step is measured by itself: processor seconds and the largest memory of the
process; with strace also the files that it opens and brings to disk. A row a step; `scale.py --draw TABLE.csv PICTURE.png`
draws them, as docs/cluster.md has them.
"""

import argparse
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import xxhash    # and nothing larger: a process is charged for the memory of the one that starts it

REPOSITORY = Path(__file__).resolve().parents[2]
METHODS = 4
STUDY = """title = "Many tiny runs"
seeds = {seeds}
passes = 2
threads = 1
photons_per_pass = 50
resolution = [16, 16]
decomposition = {decomposition}
scenes = [{{ path = "{repository}/scenes/cornell-box/scene.xml" }}]
[[method]]
integrator = "ppm"
alpha = [0.5, 0.7]
[[method]]
integrator = "photonmapper"
[[method]]
integrator = "path"
"""


def write_study(folder, runs, decomposition="false"):
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "scale.toml"
    file.write_text(STUDY.format(seeds=runs // METHODS, decomposition=decomposition, repository=REPOSITORY))
    return file


def measured(command):
    """Processor seconds and the largest memory in MiB of a command."""
    process = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{command}: ended with {os.waitstatus_to_exitcode(status)}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def traced(command):
    """Files opened and brought to disk; None without strace."""
    if not shutil.which("strace"):
        return None, None
    with tempfile.NamedTemporaryFile("r") as log:
        subprocess.run(["strace", "-f", "-o", log.name, "-e", "trace=open,openat,fsync", *map(str, command)], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        lines = log.read().splitlines()
    return (sum(bool(re.search(r"open(at)?\(.*\) = \d", line)) for line in lines), sum("fsync(" in line for line in lines))


def hash_of(data):
    return xxhash.xxh3_128_hexdigest(data)


def replay(program, study, results, runs):
    """Every run's folder, from those of the first seed, whose keys are told by the sums that they would be in."""
    template = results.parent / "template"
    first = write_study(template, METHODS, decomposition="true")
    subprocess.run([program, "run", first, "-o", template / "results"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for folder in sorted((template / "results/runs").iterdir()):
        description = json.loads((folder / "run.json").read_text())
        description.pop("checksum")
        point_key = description["ensemble"]["key"]
        header, *rows = (folder / "iterations.csv").read_text().splitlines()
        seed_column = header.split(",").index("seed")
        snapshots = json.dumps([one["pass"] for one in description["snapshots"]]).replace(" ", "")
        for seed in range(1, runs // METHODS + 1):
            name = f"{folder.name.rpartition('-')[0]}-{seed}"
            cells = [row.split(",") for row in rows]
            for row in cells:
                row[seed_column], row[2] = str(seed), name
            table = ("\n".join([header, *(",".join(row) for row in cells)]) + "\n").encode()
            key = hash_of(f"{point_key} {seed} {snapshots}".encode())
            files = {**description["files"], "iterations.csv": {"bytes": len(table), "hash": hash_of(table)}}
            text = json.dumps({**description, "run": name, "seed": seed, "key": key, "ensemble": None, "files": files},
                              indent=2)[:-2].encode()
            made = results / "runs" / name
            (made / "snapshots").mkdir(parents=True)
            (made / "iterations.csv").write_bytes(table)
            for snapshot in (folder / "snapshots").iterdir():
                os.link(snapshot, made / "snapshots" / snapshot.name)
            (made / "run.json").write_bytes(text + b',\n  "checksum": "' + hash_of(text).encode() + b'"\n}\n')


def steps(program, folder, runs, is_replayed):
    """(step, processor seconds, MiB, files opened, files brought to disk) of a study."""
    study, results = write_study(folder, runs), folder / "results"
    of_study = [program, "run", study, "-o", results]
    if is_replayed:
        replay(program, study, results, runs)
        measured([*of_study, "--group", 1, "--no-merge"])    # the first, in a folder that nobody has claimed, looks at all of it
    else:
        yield "make all groups", *measured([*of_study, "--no-merge"]), None, None
    group = runs // METHODS // 2
    job = [*of_study, "--group", group, "--no-merge"]

    def unmake():
        for run in (results / "runs").glob(f"*_seed-{group}"):
            shutil.rmtree(run)
    unmake()
    costs = measured(job)
    unmake()
    yield "a job makes its group", *costs, *traced(job)
    yield "a job finds its group finished", *measured(job), *traced(job)
    merge = [program, "merge", results]
    costs = measured(merge)
    (results / "iterations.csv").unlink()
    yield "merge", *costs, *traced(merge)
    yield "merge where nothing has changed", *measured(merge), *traced(merge)
    yield "run where all is finished", *measured(of_study), *traced(of_study)
    yield "list as JSON", *measured([*of_study, "--list", "--json"]), None, None
    if is_replayed:
        return    # the analysis reads all rows, 6 kB of memory each
    yield "analysis: a figure", *measured(["/usr/bin/python3", REPOSITORY / "analysis", "memory", results]), None, None


def draw(table, picture):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    with open(table, newline="") as stream:
        rows = list(csv.DictReader(stream))
    figure, (each, job) = pyplot.subplots(1, 2, figsize=(8, 3.2), sharex=True)
    for axes, divided, title in [(each, True, "a run, of what looks at all of them"), (job, False, "a job of four runs")]:
        for step in dict.fromkeys(row["step"] for row in rows):
            if step.startswith("a job") != divided and not step.startswith("analysis"):
                own = [row for row in rows if row["step"] == step]
                runs = [int(row["runs"]) for row in own]
                axes.loglog(runs, [1e3 * float(row["cpu_seconds"]) / (count if divided else 1) for row, count in zip(own, runs)],
                            "o-", label=step)
        axes.set(xlabel="runs of the study", ylabel="processor time in ms", title=title)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=6)
    figure.tight_layout()
    figure.savefig(picture, dpi=130)


def main():
    if sys.argv[1:2] == ["--draw"]:
        return draw(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--made", type=int, nargs="*", default=[100, 1000, 10000])
    parser.add_argument("--replayed", type=int, nargs="*", default=[100000])
    parser.add_argument("-o", dest="output", type=Path, default=Path("scale.csv"))
    arguments = parser.parse_args()
    with open(arguments.output, "w", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["runs", "replayed", "step", "cpu_seconds", "peak_rss_mib", "files_opened", "files_synced"])
        for runs, is_replayed in [*((runs, False) for runs in arguments.made), *((runs, True) for runs in arguments.replayed)]:
            folder = arguments.folder / f"{runs}"
            shutil.rmtree(folder, ignore_errors=True)
            for step, seconds, mebibytes, opened, synced in steps(arguments.program.resolve(), folder, runs, is_replayed):
                table.writerow([runs, int(is_replayed), step, f"{seconds:.3f}", f"{mebibytes:.1f}", opened, synced])
                stream.flush()
                print(runs, step, f"{seconds:.3f} s, {mebibytes:.0f} MiB, opened {opened}, synced {synced}", flush=True)
            shutil.rmtree(folder)


if __name__ == "__main__":
    main()
