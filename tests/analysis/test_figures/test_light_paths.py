"""What light paths cost and bring is drawn of the records, and what emission has learnt of its own table."""

import json
import unittest

import numpy

from photonlab.figures import emission, light_paths
from photonlab.records import columns, kept_files, runs
from support import stamps, synthetic
from support.in_folder import InFolder

MEASURES = ["paths_traced", "paths_seen", "mutations_accepted"]
LEARNT = "light,kind,square,row,column,plain,probability,paths,acceptances\n"


class LightPaths(InFolder):
    def write(self, seen):
        """Of one method whose MSE is its seed over the passes, and which traces two paths for each that it emits."""
        made = synthetic.rows(lambda seed, number, _: seed / max(number, 1), seeds=[1, 2, 3], passes=[0, 1, 2, 4])
        for row in made:
            row.update(paths_traced=str(2000 * int(row["pass"])), paths_seen=seen, mutations_accepted="0.25",
                       cpu_seconds=str(0.5 * int(row["pass"])))
        synthetic.write_csv(self.results, made, [*synthetic.COLUMNS, *MEASURES])
        described = json.loads(columns.BEFORE_DESCRIPTIONS.read_text(encoding="utf-8"))
        described["columns"] += [{"name": name, "kind": "measure", "type": "number"} for name in MEASURES]
        stamps.write_with_checksum(self.results / "columns.json", described)

    def test_errors_are_means_over_seeds_with_their_standard_error(self):
        self.write("0.1")
        rows = self.read().rows
        curve = light_paths.error_curve(rows[rows["component"] == "gathered"], "mse_unbiased")
        self.assertEqual(list(curve.index), [1, 2, 4])
        self.assertEqual(list(curve["mean"]), [2, 1, 0.5])
        numpy.testing.assert_allclose(curve["deviation"], numpy.array([1, 0.5, 0.25]) / numpy.sqrt(3))
        numpy.testing.assert_allclose(list(curve["cpu_seconds"]), [0.5, 1, 2])

    def test_is_drawn_where_some_method_says_what_is_seen(self):
        self.write("0.1")
        self.assertTrue(light_paths.chooses_paths(self.read()))
        self.assertIn("light-paths-cornell-box.png", self.output_of("light_paths"))

    def test_is_not_drawn_where_none_does(self):
        self.write("")
        self.assertFalse(light_paths.chooses_paths(self.read()))


class Emission(InFolder):
    def run_with(self, table):
        self.results.mkdir(parents=True, exist_ok=True)
        (self.results / emission.FILE).write_text(table, encoding="utf-8")
        stamp = {"bytes": len(table), "hash": kept_files.hash_of(table.encode())}
        return runs.Run(self.results, {"files": {emission.FILE: stamp}}, {})

    def test_shows_how_many_times_as_many_paths_leave_the_brightest_lights_first(self):
        table = LEARNT + "0,point,direction,0,0,0.05,0.05,1,0\n0,point,direction,0,1,0.05,0.1,1,1\n" \
                         "0,point,direction,1,0,0.05,0.025,1,0\n0,point,direction,1,1,0.05,0.025,1,0\n" \
                         "1,directional,position,0,0,0.8,0.8,1,1\n"
        (bright, square, one), (faint, _, times) = emission.maps_of(self.run_with(table))
        self.assertEqual((bright, square), ("light 1 (directional): 80% of paths, 80% by plain emission", "position"))
        self.assertEqual(faint, "light 0 (point): 20% of paths, 20% by plain emission")
        numpy.testing.assert_allclose(one, [[1]])
        numpy.testing.assert_allclose(times, [[1, 2], [0.5, 0.5]])

    def test_a_table_that_was_changed_is_refused(self):
        run = self.run_with(LEARNT + "0,point,direction,0,0,1,1,1,1\n")
        (self.results / emission.FILE).write_text(LEARNT + "0,point,direction,0,0,1,2,1,1\n", encoding="utf-8")
        with self.assertRaisesRegex(emission.files.InputError, "is not what was written"):
            emission.maps_of(run)


if __name__ == "__main__":
    unittest.main()
