"""What records.py makes of iterations.csv, and what it refuses."""

import math
import unittest

from photonlab.records import files, methods, references
from photonlab.statistics import errors
from support import synthetic
from support.in_folder import InFolder


class Folder(InFolder):
    def rows_of(self, made, **options):
        synthetic.write_csv(self.results, made, **options)
        return self.read().rows

    def found(self, made, **options):
        synthetic.write_csv(self.results, made, **options)
        return self.read()


def constant(value):
    return lambda seed, number, component: value


class Reading(Folder):
    def test_numbers_are_numbers_settings_are_text_and_empty_is_nan(self):
        rows = self.rows_of(synthetic.rows(constant(0.25), seeds=[3], passes=[8], mse_unbiased=""))
        self.assertEqual(rows["pass"].tolist(), [8.0] * 4)
        self.assertEqual(rows["mse"].tolist(), [0.25 + 1e-6] * 4)
        self.assertEqual(rows["alpha"].tolist(), ["0.7"] * 4)
        self.assertEqual(rows["k"].tolist(), [""] * 4)

    def test_an_empty_measurement_is_nan_and_a_negative_one_is_kept(self):
        made = synthetic.rows(constant(-1e-9), seeds=[1], passes=[1])
        made[0]["reference_floor"] = ""
        rows = self.rows_of(made)
        self.assertTrue(math.isnan(rows["reference_floor"].iloc[0]))
        self.assertEqual(rows["mse_unbiased"].tolist(), [-1e-9] * 4)

    def test_columns_may_come_in_another_order_and_more_of_them(self):
        rows = self.rows_of(synthetic.rows(constant(1.0)), columns=[*reversed(synthetic.COLUMNS), "new"])
        self.assertEqual(len(rows), 128)

    def refused(self, *parts):
        with self.assertRaises(files.InputError) as caught:
            self.read()
        for part in parts:
            self.assertIn(part, str(caught.exception))

    def test_refuses_a_folder_that_is_not_there(self):
        self.results = self.results / "none"
        self.refused("none", "is not a folder")

    def test_refuses_a_folder_without_records(self):
        self.refused("iterations.csv: is not there", "photonlab run")

    def test_refuses_an_empty_file(self):
        (self.results / "iterations.csv").write_text("")
        self.refused("iterations.csv: is not a table in CSV: it is empty")

    def test_refuses_what_is_not_text(self):
        (self.results / "iterations.csv").write_bytes(b"\x89PNG\r\n\x1a\n\x00\xff\xfe")
        self.refused("iterations.csv: is not text in UTF-8: byte 1")

    def test_refuses_a_header_without_rows(self):
        synthetic.write_csv(self.results, [])
        self.refused("iterations.csv: has no rows")

    def test_names_missing_columns(self):
        synthetic.write_csv(self.results, synthetic.rows(constant(1.0)),
                            columns=[column for column in synthetic.COLUMNS if column not in ("run", "pass")])
        self.refused("lacks the columns run, pass;", "schema 1")

    def test_refuses_another_schema(self):
        synthetic.write_csv(self.results, synthetic.rows(constant(1.0), schema="2"))
        self.refused("iterations.csv:2: unknown schema \"2\"; known here: 1")

    def test_refuses_an_unknown_component(self):
        made = synthetic.rows(constant(1.0))
        made[5]["component"] = "caustics"
        synthetic.write_csv(self.results, made)
        self.refused("iterations.csv:7: unknown component \"caustics\"", "total, emission, direct, gathered")

    def test_refuses_what_is_not_a_number_and_says_where(self):
        made = synthetic.rows(constant(1.0))
        made[2]["rmse"] = "0,5"
        synthetic.write_csv(self.results, made)
        self.refused("iterations.csv:4: rmse is \"0,5\"; expected a number")

    def test_refuses_a_pass_that_is_not_whole_or_is_negative(self):
        for text in ["1.5", "-1"]:
            made = synthetic.rows(constant(1.0))
            made[0]["pass"] = text
            synthetic.write_csv(self.results, made)
            self.refused(f"iterations.csv:2: pass is \"{text}\"; expected a whole number")

    def test_refuses_a_row_that_was_cut(self):
        synthetic.write_csv(self.results, synthetic.rows(constant(1.0)))
        file = self.results / "iterations.csv"
        file.write_text(file.read_text().rstrip()[:-30])
        self.refused("iterations.csv:129: has ", " fields; the header has 55")

    def test_refuses_a_row_with_too_many_fields(self):
        synthetic.write_csv(self.results, synthetic.rows(constant(1.0)))
        with open(self.results / "iterations.csv", "a") as file:
            file.write("," * 60 + "\n")
        self.refused("iterations.csv:130: has 61 fields; the header has 55")

    def test_refuses_a_repeated_row(self):
        made = synthetic.rows(constant(1.0))
        synthetic.write_csv(self.results, [*made, made[0]])
        self.refused("iterations.csv:130: run ppm-seed-1 repeats pass 0, total")


class Methods(Folder):
    def labels(self, *methods):
        made = []
        for settings in methods:
            made += synthetic.rows(constant(1.0), seeds=[1, 2], passes=[1], **settings)
        return self.found(made).labels

    def test_one_method_is_named_by_its_integrator(self):
        self.assertEqual(self.labels({}), ["PPM"])

    def test_runs_with_other_numbers_of_threads_are_repetitions_too_even_within_a_run(self):
        made = synthetic.rows(constant(1.0), seeds=[1, 2], passes=[1, 2])
        for row in made:
            row["threads"] = "2" if row["seed"] == "1" else row["pass"]
        found = self.found(made)
        self.assertEqual(found.labels, ["PPM"])
        self.assertEqual(methods.table_settings(found.rows, found.columns)["threads"], "2;1")

    def test_seeds_are_repetitions_of_one_method(self):
        rows = self.rows_of(synthetic.rows(constant(1.0), seeds=[1, 2, 3]))
        self.assertEqual(set(rows["method"]), {"PPM"})

    def test_a_label_names_what_differs_and_no_more(self):
        self.assertEqual(self.labels({"alpha": "0.5"}, {"alpha": "0.9"}, synthetic.PM_RADIUS, synthetic.PM_NEAREST),
                         ["PM, radius", "PM, nearest", "PPM, α = 0.5", "PPM, α = 0.9"])

    def test_numbers_are_ordered_as_numbers(self):
        self.assertEqual(self.labels({"photons_per_pass": "100000"}, {"photons_per_pass": "9000"}),
                         ["PPM, photons a pass = 9000", "PPM, photons a pass = 100000"])

    def test_given_radii_are_named_by_the_radius(self):
        self.assertEqual(self.labels({"radius_rule": "given", "radius_initial": "2"}, {}),
                         ["PPM, initial radius = 2", "PPM, initial radius = 12.35"])

    def test_a_caustic_radius_is_named_where_it_is_not_the_radius(self):
        given = {**synthetic.PM_RADIUS, "radius_rule": "given"}
        self.assertEqual(self.labels({**given, "radius_initial": "4", "caustic_radius": "4"},
                                     {**given, "radius_initial": "8", "caustic_radius": "8"}),
                         ["PM, initial radius = 4", "PM, initial radius = 8"])
        self.assertEqual(self.labels({**given, "radius_initial": "4", "caustic_radius": "2"},
                                     {**given, "radius_initial": "4", "caustic_radius": "4"}),
                         ["PM, caustic radius = 2", "PM, caustic radius = 4"])

    def test_a_setting_that_the_contract_does_not_know_tells_methods_apart(self):
        made = []
        for drift in ["0", "0.5"]:
            for row in synthetic.rows(constant(1.0), seeds=[1, 2], passes=[1]):
                made.append({**row, "run": f"box_drift-{drift}_seed-{row['seed']}", "drift": drift, "measured": str(len(made))})
        found = self.found(made, columns=[*synthetic.COLUMNS, "drift", "measured"])
        self.assertEqual(methods.settings_of(found.rows, found.columns), [*found.columns.settings, "drift"])
        self.assertEqual(found.labels, ["PPM, drift = 0", "PPM, drift = 0.5"])

    def test_radii_that_only_differ_from_scene_to_scene_are_not_named(self):
        self.assertEqual(self.labels({}, {"scene": "other", "radius_initial": "3"}), ["PPM"])

    def test_methods_that_only_an_empty_setting_tells_apart_get_labels_of_their_own(self):
        self.assertEqual(self.labels({"max_depth": ""}, {"max_depth": "5"}), ["PPM", "PPM, max depth = 5"])

    def test_integrators_that_are_not_known_here_are_named_as_they_are(self):
        self.assertEqual(self.labels({}, {"integrator": "sppm"}), ["PPM", "sppm"])

    def named(self, *methods, recorded=False):
        """Labels of methods that are (point, settings), as runs are called, or with the column `method` (name, settings)."""
        made = []
        for place, (name, settings) in enumerate(methods):
            point, column = (f"{name}_{place}", {"method": name}) if recorded else (name, {})
            for row in synthetic.rows(constant(1.0), seeds=[1, 2], passes=[1], **settings):
                made.append({**row, "run": f"{row['scene']}_{point}_seed-{row['seed']}", **column})
        return self.found(made, columns=[*synthetic.COLUMNS, "method"] if recorded else None).labels

    def test_a_method_is_called_as_the_experiment_calls_it(self):
        methods_of_two_kinds = [("plain photon mapping", synthetic.PM_RADIUS), ("slow_alpha-0.9", {"alpha": "0.9"}), ("ppm", {})]
        self.assertEqual(self.named(*methods_of_two_kinds, recorded=True), ["plain photon mapping", "PPM", "slow_alpha-0.9"])
        self.assertEqual(self.named(*methods_of_two_kinds), ["plain photon mapping", "PPM", "slow"])

    def test_what_is_swept_under_a_name_is_named_behind_it_and_nothing_else(self):
        self.assertEqual(self.named(("mine_alpha-0.5", {"alpha": "0.5"}), ("mine_alpha-0.9", {"alpha": "0.9"}),
                                    ("other", {"kernel": "cone", "footprints": "1"})), ["mine, α = 0.5", "other", "mine, α = 0.9"])

    def test_methods_of_the_same_settings_under_two_names_are_two_methods(self):
        self.assertEqual(self.named(("short", {}), ("long", {}), recorded=True), ["long", "short"])

    def test_no_two_methods_of_a_scene_have_one_label(self):
        close = ["0.66666666", "0.66666667"]
        for labels in [self.labels(*({"alpha": alpha} for alpha in close)),
                       self.named(*(("mine", {"alpha": alpha}) for alpha in close), recorded=True),
                       self.named(("PPM", {"kernel": "cone"}), ("ppm", {}), recorded=True)]:
            self.assertEqual(len(set(labels)), 2, labels)


class Aggregation(Folder):
    def curve(self, made, column="mse_unbiased"):
        rows = self.rows_of(made)
        return errors.aggregate_over_seeds(rows[rows["component"] == "gathered"], column)

    def test_mean_least_and_largest_are_exact(self):
        curve = self.curve(synthetic.rows(lambda seed, number, component: float(seed * number), seeds=[1, 2, 6],
                                          passes=[1, 4]))
        self.assertEqual(curve.index.tolist(), [1, 4])
        self.assertEqual(curve["seeds"].tolist(), [3, 3])
        self.assertEqual(curve["mean"].tolist(), [3.0, 12.0])
        self.assertEqual(curve["least"].tolist(), [1.0, 4.0])
        self.assertEqual(curve["largest"].tolist(), [6.0, 24.0])
        self.assertEqual(curve["seconds"].tolist(), [0.26, 1.01])

    def test_errors_of_both_signs_are_averaged_before_the_root(self):
        curve = self.curve(synthetic.rows(lambda seed, number, component: 3.0 if seed == 1 else -1.0, seeds=[1, 2],
                                          passes=[1]))
        self.assertEqual(curve["mean"].tolist(), [1.0])
        self.assertEqual(curve["least"].tolist(), [-1.0])

    def test_a_pass_that_not_every_seed_recorded_is_left_out(self):
        made = synthetic.rows(constant(1.0), seeds=[1], passes=[1, 2, 4]) + \
            synthetic.rows(constant(1.0), seeds=[2], passes=[1, 2])
        self.assertEqual(self.curve(made).index.tolist(), [1, 2])

    def test_a_seed_without_a_value_is_not_hidden_by_the_others(self):
        made = synthetic.rows(lambda seed, number, component: math.nan if seed == 2 else 1.0, seeds=[1, 2], passes=[1])
        self.assertTrue(math.isnan(self.curve(made)["mean"].iloc[0]))

    def test_the_unbiased_error_is_used_where_there_is_one(self):
        made = synthetic.rows(constant(1.0))
        self.assertEqual(errors.error_column(self.rows_of(made)), "mse_unbiased")
        for row in made:
            row["mse_unbiased"] = ""
        self.assertEqual(errors.error_column(self.rows_of(made)), "mse")

    def test_the_root_of_nothing_or_less_is_no_number(self):
        self.assertEqual(errors.root(0.25), 0.5)
        self.assertTrue(math.isnan(errors.root(0.0)))
        self.assertTrue(math.isnan(errors.root(-1.0)))
        self.assertTrue(math.isnan(errors.root(math.nan)))


class Runs(Folder):
    def written(self, *arguments, **options):
        """The records of a run "r" and what it left."""
        synthetic.write_csv(self.results, [{**row, "run": "r"} for row in synthetic.rows(constant(1.0), seeds=[1])])
        synthetic.write_run(self.results, "r", *arguments, **options)
        found = self.read()
        return found, found.run("r")

    def test_reads_what_a_run_wrote(self):
        found, run = self.written([1, 64], None)
        self.assertEqual(run.snapshots, {})    # which are not there
        self.assertIsNone(references.reference_of(found, run.description))
        file = self.results / "runs/r/snapshots/pass-000064.exr"
        file.parent.mkdir()
        file.touch()
        self.assertEqual(self.read().run("r").snapshots, {64: file})

    def test_refuses_a_run_that_is_not_there_or_not_json_or_something_else(self):
        found, _ = self.written([], None)
        self.assertTrue(found.has_run("r"))
        self.assertFalse(found.has_run("none"))
        with self.assertRaisesRegex(files.InputError, "run.json: cannot be read"):
            found.run("none")
        for text, message in [("{", "run.json: is not JSON"), ("[]", "expected \"snapshots\""),
                              ('{"snapshots": [{"pass": "1", "file": "x"}]}', "expected \"snapshots\""),
                              ('{"snapshots": [], "reference": "x"}', "expected \"reference\""),
                              ('{"snapshots": [], "reference": {"path": 5}}', "expected \"reference\""),
                              ('{"snapshots": [], "reference": {"path": "x", "key": 5}}', "expected \"reference\""),
                              ('{"snapshots": [], "working_directory": 5}', "expected \"working_directory\""),
                              ('{"snapshots": [], "files": []}', "expected \"files\"")]:
            (self.results / "runs/r/run.json").write_text(text)
            with self.assertRaisesRegex(files.InputError, message):
                self.read().run("r")

    def test_a_reference_is_found_from_the_folder_in_which_the_run_was_started(self):
        start = self.results / "start"
        (start / "reference/box").mkdir(parents=True)
        found, run = self.written([], "reference/box", working_directory=str(start))
        judge = references.reference_of(found, run.description)
        self.assertEqual((judge.path, judge.halves, judge.why_not), ("reference/box", [], "is not there"))
        for half in ["half_a.exr", "half_b.exr"]:
            (start / "reference/box" / half).touch()
        self.assertEqual(references.reference_of(found, run.description).halves,
                         [start / "reference/box/half_a.exr", start / "reference/box/half_b.exr"])

    def test_a_single_image_is_a_reference_too(self):
        image = self.results / "other-renderer.exr"
        image.touch()
        found, run = self.written([], str(image))
        self.assertEqual(references.reference_of(found, run.description).halves, [image])


if __name__ == "__main__":
    unittest.main()
