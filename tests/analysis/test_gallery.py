"""The gallery puts PPM above PM, a column a recorded pass, and says under each picture what the records say."""

import tempfile
import unittest
from pathlib import Path

import synthetic

try:
    import gallery
    import records
    from test_strip import layered, write_exr
except ImportError as error:
    raise unittest.SkipTest(f"{error} (Debian: python3-openimageio)")


class Gallery(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.results = Path(folder.name)

    def make_results(self, passes, reference=None):
        made = synthetic.rows(lambda seed, number, component: 4e-4, seeds=[1], **synthetic.PM_RADIUS)
        made += synthetic.rows(lambda seed, number, component: 1e-4, seeds=[1, 2])
        synthetic.write_csv(self.results, made)
        for run in sorted({row["run"] for row in made}):
            folder = synthetic.write_run(self.results, run, passes, reference, working_directory=str(self.results))
            for number in passes:
                write_exr(folder / f"snapshots/pass-{number:06}.exr", layered(1.0, 0.5))
        if reference:
            for half in ["half_a", "half_b"]:
                write_exr(self.results / reference / f"{half}.exr", layered(1.0, 0.5))

    def collected(self):
        rows = records.read(self.results).rows
        labels = records.methods_in_order(rows)
        return gallery.collect(records.read(self.results), "cornell-box", rows, labels)

    def test_ppm_stands_above_pm_at_every_recorded_pass(self):
        self.make_results([0, 1, 64])
        methods, reference, _ = self.collected()
        self.assertEqual([label for label, _ in methods], ["PPM", "PM, radius"])
        self.assertEqual([list(images) for _, images in methods], [[0, 1, 64]] * 2)
        self.assertIsNone(reference)

    def test_captions_are_the_records(self):
        self.make_results([1])
        methods, *_ = self.collected()
        self.assertEqual([images[1][1] for _, images in methods], ["RMSE 0.010, 0.26 s", "RMSE 0.020, 0.26 s"])

    def test_figures_are_written_with_and_without_a_reference(self):
        for reference in [None, "reference/box"]:
            self.make_results([0, 64], reference)
            code, output, errors = synthetic.run(gallery, self.results)
            self.assertEqual((code, errors), (0, ""))
            for name in ["gallery.png", "gallery.pdf"]:
                self.assertTrue((self.results / "figures" / name).is_file())
                self.assertIn(name, output)

    def test_a_folder_without_snapshots_is_refused(self):
        self.make_results([])
        code, _, errors = synthetic.run(gallery, self.results)
        self.assertEqual(code, 2)
        self.assertIn("expected some in the experiment file", errors)


if __name__ == "__main__":
    unittest.main()
