"""The one command: what it calls, what it says of records that changed, and rows made again from tables that are known."""

import contextlib
import io
import json
import stat
import tomllib
import unittest
from pathlib import Path

from photonlab.records import columns, records, tables
from photonlab.records.files import InputError
from photonlab.replications import checksums, command, making, variants
from photonlab.replications.rows import ROWS
from support import ROOT, stamps, synthetic
from support.in_folder import InFolder, run


def described_as(results, described):
    """columns.json, as the program writes it."""
    stamps.write_with_checksum(results / "columns.json", {"schema": 1, "columns": described})


class Checksums(InFolder):
    """Of records that are made up."""

    def write(self, change=lambda row: row, extra=()):
        made = synthetic.rows(lambda seed, number, component: 1e-4 * seed / (number + 1))
        synthetic.write_csv(self.results, [change(dict(row)) for row in made], [*synthetic.COLUMNS, *extra])
        return checksums.table_of(records.read(self.results))

    def test_are_of_settings_and_measures_alone(self):
        names = [row["column"] for row in self.write()]
        described = {column.name: column for column in columns.before_descriptions()}
        self.assertIn("mse", names)
        self.assertIn("alpha", names)
        for name in ["seconds", "run", "threads", "map_bytes", "peak_rss_mib"]:
            self.assertNotIn(name, names)
            self.assertIn(name, described)

    def test_of_the_same_records_at_other_times_and_in_another_order_are_the_same(self):
        kept = self.write()
        again = self.write(lambda row: {**row, "seconds": "7.5", "threads": "1", "map_bytes": "12345"})
        self.assertEqual(checksums.compared(kept, again).state, checksums.SAME)
        made = synthetic.rows(lambda seed, number, component: 1e-4 * seed / (number + 1))
        synthetic.write_csv(self.results, made[::-1])
        self.assertEqual(checksums.compared(kept, checksums.table_of(records.read(self.results))).state, checksums.SAME)

    def test_tell_another_number_from_another_rounding_and_name_the_column(self):
        kept = self.write()
        other = checksums.compared(kept, self.write(lambda row: {**row, "mse": repr(1.001 * float(row["mse"]))}))
        self.assertEqual(other.state, checksums.OTHER)
        self.assertRegex(str(other), r"^other numbers: mse has the mean 7\.135\d*e-05, had 7\.127\d*e-05$")
        rounded = checksums.compared(kept, self.write(lambda row: {**row, "mse": repr((1 + 1e-7) * float(row["mse"]))}))
        self.assertEqual(rounded.state, checksums.CLOSE_ENOUGH)

    def test_of_another_setting_are_other_numbers(self):
        kept = self.write()
        self.assertEqual(checksums.compared(kept, self.write(lambda row: {**row, "kernel": "cone"})).state, checksums.OTHER)

    def test_a_column_more_is_no_difference_and_one_less_is(self):
        kept = self.write()
        described = json.loads(columns.BEFORE_DESCRIPTIONS.read_text())["columns"]
        described_as(self.results, [*described, {"name": "new", "kind": "measure", "type": "number"}])
        more = self.write(lambda row: {**row, "new": "3"}, extra=["new"])
        self.assertEqual(more[-1]["column"], "new")
        self.assertEqual(checksums.compared(kept, more).state, checksums.SAME)
        self.assertEqual(checksums.compared(more, kept).state, checksums.OTHER)

    def test_are_read_as_they_were_written(self):
        kept = self.write()
        checksums.write(self.results / "kept.csv", kept)
        self.assertEqual(checksums.compared(checksums.read(self.results / "kept.csv"), kept).state, checksums.SAME)


class Variants(unittest.TestCase):
    FILE = ROOT / "experiments/pm-vs-ppm.toml"

    def changed(self, file=FILE, **changes):
        return variants.changed(variants.read(file), file.parent, variants.Variant(**changes), Path("/references"))

    def test_have_other_seeds(self):
        experiment, needed, left_out = self.changed(first_seed=501, seeds=4)
        self.assertEqual(experiment["seeds"], [501, 502, 503, 504])
        self.assertEqual((needed, left_out), ([], []))
        self.assertEqual(self.changed()[0]["seeds"], list(range(1, 17)))

    def test_have_regions_at_the_same_place_and_references_of_their_own(self):
        experiment, needed, left_out = self.changed(resolution=64, samples=32)
        scene = experiment["scenes"][0]
        self.assertEqual(scene["regions"], {"smooth": [32, 17, 48, 25], "edge": [11, 22, 17, 35]})
        self.assertEqual((scene["resolution"], scene["reference"]), ([64, 64], "/references/cornell-box-64"))
        self.assertEqual(needed[0].scene, ROOT / "scenes/cornell-box/scene.xml")
        self.assertEqual(" ".join(needed[0].arguments), "--resolution 64x64 --samples-per-pixel 1")
        self.assertEqual(needed[0].samples, 32)
        self.assertEqual(left_out, [])

    def test_keep_what_a_reference_is_of(self):
        _, needed, _ = self.changed(ROOT / "experiments/positions.toml", resolution=64)
        self.assertIn("--positions box", " ".join(needed[0].arguments))

    def test_need_no_reference_of_scenes_without_a_run(self):
        file = ROOT / "experiments/edges.toml"
        experiment, needed, _ = variants.changed(variants.read(file), file.parent, variants.Variant(resolution=64), Path("/references"),
                                                 ("cornell-box_ppm_*",))
        self.assertEqual([variants.name_of(scene) for scene in experiment["scenes"]], ["cornell-box"])
        self.assertEqual(len(needed), 1)
        self.assertEqual(len(self.changed(file, resolution=64)[1]), 3)

    def test_leave_out_what_paths_cannot_judge(self):
        experiment, _, left_out = self.changed(ROOT / "experiments/replications/relaxation.toml", resolution=64)
        self.assertEqual([Path(scene["path"]).parent.name for scene in experiment["scenes"]], ["cornell-spheres"])
        self.assertEqual(left_out, ["water: its reference is by ppm, and is made at no other resolution here"])

    def test_have_fewer_passes_in_proportion(self):
        experiment, _, _ = self.changed(ROOT / "experiments/tradeoff.toml", passes=16)
        passes = {method["name"]: method.get("passes") for method in experiment["method"]}
        self.assertEqual((experiment["passes"], experiment["record"]), (16, [16]))
        self.assertEqual((passes["default"], passes["photons-6250"], passes["photons-400000"]), (None, 256, 4))

    def test_are_written_as_toml(self):
        experiment, _, _ = self.changed(first_seed=7, resolution=64)
        self.assertEqual(tomllib.loads(variants.written(experiment)), experiment)


PROGRAM = """#!/bin/sh
# Writes down how it was called: `run FILE -o FOLDER ...`. Leaves the records that are beside it, or says how long it would take.
here=$(dirname "$0")
echo "$@" >> "$here/calls"
case "$*" in
    *--list*) echo '{"groups": [{"seconds": 90.0}, {"seconds": 30.0}], "runs": []}' ;;
    *) mkdir -p "$4" && cp "$here/iterations.csv" "$4" ;;
esac
"""


class OneCommand(InFolder):
    """With a program that writes what is known."""

    def setUp(self):
        super().setUp()
        self.build = self.results / "build"
        self.program = self.build / "src/app/photonlab"
        self.script(self.program, PROGRAM)
        for name in ["deviations", "relaxation"]:
            self.script(self.build / making.PROGRAMS[f"{name}.csv"], f"#!/bin/sh\ncat {ROOT}/docs/replications/{name}.csv\n")
        self.script(self.build / "tests/statistical/deviations_test", "#!/bin/sh\n")
        self.write_records(1e-4)

    def write_records(self, mse):
        synthetic.write_csv(self.program.parent, synthetic.rows(lambda seed, number, component: mse, seeds=[1, 2]))

    def script(self, file, text):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        file.chmod(file.stat().st_mode | stat.S_IXUSR)

    def calls(self):
        return (self.program.parent / "calls").read_text().splitlines()

    def call(self, *arguments):
        return run(*arguments, "-o", self.results / "made", "--program", self.program, main=command.main)

    def test_rows_of_a_table_have_the_numbers_and_verdicts_of_the_page(self):
        code, output, errors = self.call(49, 50, 51, 52, 53, 54)
        self.assertEqual((code, errors), (0, ""), output)
        self.assertEqual(output.count("as the page says"), 6)
        lines = tables.read_table(self.results / "made/as-written/replications.csv")
        self.assertEqual(set(lines["agreement"]), {"as stated"})
        self.assertEqual(list(dict.fromkeys(lines["row"])), ["49", "50", "51", "52", "53", "54"])

    def test_a_test_that_fails_is_the_verdict(self):
        self.script(self.build / "tests/statistical/deviations_test", "#!/bin/sh\nexit 1\n")
        code, output, _ = self.call(51)
        self.assertEqual(code, 1)
        self.assertIn("row 51, deviations.csv: tests/statistical/deviations_test fails, the page says held", output)

    def test_what_cannot_be_made_leaves_the_other_rows(self):
        (self.build / making.PROGRAMS["deviations.csv"]).unlink()
        code, output, errors = self.call(7, 54)
        self.assertEqual(code, 2)
        self.assertIn("cmake --build --preset release --target deviation_curves", errors)
        self.assertIn("row 54, deviations.csv: not made, the page says held", output)
        self.assertIn("row 7, paper-2011: not made", output)
        self.assertIn("has no ensembles", output)

    def test_runs_are_those_that_rows_need_each_once(self):
        self.call(13, 18, 22)
        self.assertEqual([line.partition(" --only ")[2] for line in self.calls()],
                         [f"*_{name}_seed-*" for name in ["hachisuka_footprints-2", "adaptive_footprints-2",
                                                          "chi-square_test_variant-plain", "chi-square_test_variant-linear-fit"]])
        self.assertTrue(all(line.startswith(f"run {ROOT}/experiments/methods.toml -o ") for line in self.calls()))

    def test_checksums_are_of_the_runs_of_all_rows_in_small(self):
        self.call(13, "--check")
        self.assertIn("*_f-test_seed-*", [line.partition(" --only ")[2] for line in self.calls()])
        self.assertTrue(all(" --smoke " in line for line in self.calls()))

    def test_all_runs_are_made_where_a_row_needs_all(self):
        self.assertEqual(making.sources_of([ROWS[7], ROWS[9]]), {"paper-2011": ()})
        self.assertEqual(making.sources_of([ROWS[9], ROWS[7]]), {"paper-2011": ()})

    def test_times_are_added_up(self):
        code, output, _ = self.call(7, 8, "--list")
        self.assertEqual(code, 0)
        self.assertRegex(output, r"paper-2011 +about +2\.0 minutes")
        self.assertRegex(output, r"in all +about +0\.2 hours")    # 2 minutes of each of five patterns

    def test_records_are_checked_against_what_was_kept(self):
        workshop = making.Workshop(self.program, self.results / "experiments", self.results / "check", smoke=True)
        rows = [ROWS[7]]

        def outcome(keep=False):
            with contextlib.redirect_stdout(io.StringIO()) as output:
                return command.check(workshop, rows, keep), output.getvalue()
        with self.assertRaisesRegex(InputError, "paper-2011.csv"):
            outcome()
        self.assertEqual(outcome(keep=True)[0], 0)
        self.assertEqual(outcome(), (0, "paper-2011 (row 7): the same bits\n"))
        self.write_records(1.1e-4)
        code, said = outcome()
        self.assertEqual(code, 1)
        self.assertIn("other numbers: mse has the mean", said)

    def test_bad_input_is_refused(self):
        for arguments, expected in [([7, "--check", "--seeds", 3], "expected no other seeds"), ([54, "--seeds", 0], "invalid"),
                                    ([999], "is the number of no row")]:
            code, _, errors = self.call(*arguments)
            self.assertEqual(code, 2)
            self.assertIn(expected, errors)
        code, _, errors = run(7, "--program", self.results / "no", main=command.main)
        self.assertEqual(code, 2)
        self.assertIn("expected the program", errors)


if __name__ == "__main__":
    unittest.main()
