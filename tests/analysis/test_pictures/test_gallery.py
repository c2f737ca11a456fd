"""The gallery puts PPM above PM, a column a recorded pass, and says under each picture what the records say."""

import unittest

from photonlab.figures import gallery
from support import synthetic
from support.images import layered, write_exr, write_runs
from support.in_folder import InFolder


class Gallery(InFolder):
    def make_results(self, passes, reference=None):
        made = synthetic.rows(lambda seed, number, component: 4e-4, seeds=[1], **synthetic.PM_RADIUS)
        made += synthetic.rows(lambda seed, number, component: 1e-4, seeds=[1, 2])
        synthetic.write_csv(self.results, made)
        write_runs(self.results, {row["run"] for row in made}, passes, lambda *_: layered(1.0, 0.5), reference)
        if reference:
            for half in ["half_a", "half_b"]:
                write_exr(self.results / reference / f"{half}.exr", layered(1.0, 0.5))

    def test_ppm_stands_above_pm_at_every_recorded_pass(self):
        self.make_results([0, 1, 64])
        found = gallery.collect(self.read())
        self.assertEqual([label for label, _ in found.methods], ["PPM", "PM, radius"])
        self.assertEqual([list(shown) for _, shown in found.methods], [[0, 1, 64]] * 2)
        self.assertIsNone(found.reference)

    def test_captions_are_the_records(self):
        self.make_results([1])
        self.assertEqual([shown[1][1] for _, shown in gallery.collect(self.read()).methods],
                         ["RMSE 0.010, 0.26 s", "RMSE 0.020, 0.26 s"])

    def test_figures_are_written_with_and_without_a_reference(self):
        for reference in [None, "reference/box"]:
            self.make_results([0, 64], reference)
            self.assert_drawn(self.output_of("gallery"), "gallery")

    def test_a_folder_without_snapshots_is_refused(self):
        self.make_results([])
        self.assertIn("expected some in the experiment file", self.refusal_of("gallery"))


if __name__ == "__main__":
    unittest.main()
