"""Exponents are those that were put in, what is not there is said, and the runs that are asked for are those of the docstring."""

import unittest

from photonlab.figures import scaling
from photonlab.records import files
from support import synthetic
from support.in_folder import InFolder


def made_up():
    """Seconds grow with photons to the power 1, with hit points to 0.5 and with triangles to 0.1; two threads are 1.6 times as fast; PM's map grows with
    passes, PPM's does not."""
    rows = []

    def row(axis, value, threads, seconds, map_bytes, integrator="ppm"):
        rows.append({**dict.fromkeys(scaling.COLUMNS, "1"), "axis": axis, "value": str(value), "threads": str(threads),
                     "integrator": integrator, "seconds": str(seconds), "map_bytes": str(map_bytes), "peak_rss_mib": "50"})
    for threads, factor in [(1, 1.0), (2, 1 / 1.6)]:
        for photons in [10_000, 100_000, 1_000_000]:
            row("photons", photons, threads, 1e-6 * photons * factor, 64.0 * photons)
        for points in [10_000, 1_000_000]:
            row("hit_points", points, threads, 1e-4 * points ** 0.5 * factor, 6.4e6)
        for triangles in [1_000, 10_000, 1_000_000]:
            row("triangles", triangles, threads, 0.01 * triangles ** 0.1 * factor, 6.4e6)
    for passes in [1, 100, 10_000]:
        row("passes", passes, 1, 1e-3, 2.0 ** 20)
        row("passes", passes, 1, 1e-3, 2.0 ** 20 * passes, "photonmapper")
    return rows


class Scaling(InFolder):
    def write(self, rows, columns=None):
        synthetic.write_rows(self.results / "scaling.csv", columns or scaling.COLUMNS, rows)

    def test_says_how_each_grows(self):
        self.write(made_up())
        output = self.output_of("scaling")
        for said in ["1000000 photons a pass, 1 thread: 1 s a pass, exponent 1.00", "1000000 hit points, 2 threads: 0.0625 s a pass, "
                     "exponent 0.50", "1000000 triangles, 1 thread: 0.0398 s a pass, exponent 0.10", "10000 hit points: two threads are 1.60 times as fast as one",
                     "PPM, 1 to 10000 passes: map from 1 to 1 MiB, exponent 0.00; process from 50 to 50 MiB",
                     "PM, 1 to 10000 passes: map from 1 to 1e+04 MiB, exponent 1.00"]:
            self.assertIn(said, output)
        self.assert_drawn(output, "scaling")
        self.assert_drawn(output, "cores")

    def test_what_the_second_thread_does_not_shorten_stays_with_more(self):
        self.write(made_up())
        self.assertIn("1000000 photons a pass, by the model: 64 cores are 3.8 times as fast as one", self.output_of("scaling"))
        self.assertEqual(scaling.times_as_fast(1.0, 0.5, 64), 64.0)
        self.assertEqual(scaling.times_as_fast(1.0, 0.4, 64), 64.0)    # faster than can be: noise
        self.assertEqual(scaling.times_as_fast(1.0, 1.0, 64), 1.0)
        self.assertEqual(scaling.times_as_fast(1.0, 1.1, 64), 1.0)

    def test_scenes_are_known_by_their_triangles(self):
        for name in ["ply-1000.xml", "ply-20.xml", "obj-30.xml", "ply-20-glass.ply"]:
            (self.results / name).touch()
        self.assertEqual(scaling.scenes_by_triangles(self.results), {1000: self.results / "ply-1000.xml", 20: self.results / "ply-20.xml"})
        self.assertEqual(scaling.scenes_by_triangles(None), {})

    def test_a_row_is_by_the_pass(self):
        run = {"pass": "4", "integrator": "ppm", "threads": "2", "photons_per_pass": "9", "hit_points": "8", "photons_stored": "7",
               "map_bytes": "6", "hit_point_bytes": "5", "peak_rss_mib": "3", **dict.fromkeys(scaling.SECONDS, "2.0")}
        row = scaling.row_of("photons", 9, run)
        self.assertEqual(sorted(row), sorted(scaling.COLUMNS))
        self.assertEqual((row["passes"], row["seconds"], row["map_bytes"]), (4, 0.5, "6"))

    def test_refuses_what_is_not_there(self):
        self.assertIn("scaling.csv: is not there", self.refusal_of("scaling"))
        self.write(made_up(), columns=[column for column in scaling.COLUMNS if column != "map_bytes"])
        self.assertIn("lacks the columns map_bytes", self.refusal_of("scaling"))

    def test_says_which_run_failed(self):
        program = self.results / "program"
        program.write_text("#!/bin/sh\necho 'no such scene' >&2\nexit 2\n")
        program.chmod(0o755)
        with self.assertRaisesRegex(files.InputError, "render .*: no such scene"):
            scaling.make_records(program, self.results)


if __name__ == "__main__":
    unittest.main()
