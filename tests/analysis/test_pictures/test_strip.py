"""The strip reads the program's layers and foreign files, and leaves out in words what it cannot draw."""

import unittest

import numpy

from photonlab.drawing import pictures
from photonlab.figures import strip
from photonlab.records import files, images, methods, records
from support import synthetic
from support.images import grey, layered, write_exr, write_runs
from support.in_folder import InFolder


class Strip(InFolder):
    def make_results(self, reference="reference/box", passes=(1, 64), direct="sampled"):
        made = []
        for settings in [synthetic.PM_RADIUS, {"alpha": "0.5"}, {"alpha": "0.9"}]:
            made += synthetic.rows(lambda seed, number, component: 0.01, seeds=[1, 2], direct=direct, **settings)
        synthetic.write_csv(self.results, made)
        runs = sorted({row["run"] for row in made})
        write_runs(self.results, runs, passes, lambda run, _: layered(0.5 + 0.01 * runs.index(run), 0.25), reference)
        for name, value in [("half_a", 0.49), ("half_b", 0.51)]:
            write_exr(self.results / "reference/box" / f"{name}.exr", layered(value, 0.25))
        return self.results

    def test_channels_are_found_by_name_in_any_order(self):
        file = self.results / "image.exr"
        write_exr(file, layered(0.5, 0.25))
        self.assertEqual(images.read_component(file, "total")[0, 0].tolist(), [0.75, 1.5, 2.25])
        self.assertEqual(images.read_component(file, "direct")[0, 0].tolist(), [0.25, 0.5, 0.75])
        self.assertEqual(images.read_component(file, "gathered", photons_carry_direct=True)[0, 0].tolist(),
                         [0.75, 1.5, 2.25])

    def test_half_floats_of_other_programs_are_read(self):
        file = self.results / "half.exr"
        write_exr(file, {channel: numpy.full((2, 3), 0.5) for channel in "RGBA"}, kind="half")
        colour = images.read_component(file, "total")
        self.assertEqual((colour.shape, colour.dtype, colour[1, 2, 0]), ((2, 3, 3), numpy.float64, 0.5))
        self.assertIsNone(images.read_component(file, "gathered"))

    def test_refuses_what_is_no_image_or_has_no_colour(self):
        file = self.results / "bad.exr"
        file.write_text("no")
        with self.assertRaisesRegex(files.InputError, "bad.exr: cannot be read"):
            images.read_component(file, "total")
        write_exr(file, {"Y": numpy.ones((2, 2))})
        with self.assertRaisesRegex(files.InputError, "bad.exr: has no channels R, G, B"):
            images.read_component(file, "total")

    def test_refuses_a_cut_image(self):
        file = self.results / "cut.exr"
        write_exr(file, {channel: numpy.random.default_rng(1).random((64, 64)) for channel in "RGB"})
        file.write_bytes(file.read_bytes()[:10000])
        with self.assertRaisesRegex(files.InputError, "cut.exr: "):
            images.read_component(file, "total")

    def test_the_mean_of_the_halves_is_the_reference(self):
        self.make_results()
        halves = [self.results / f"reference/box/half_{half}.exr" for half in "ab"]
        self.assertAlmostEqual(images.read_reference(halves, "gathered", False)[0, 0, 0], 0.5, places=6)

    def test_pictures_follow_srgb_and_show_nan_in_magenta(self):
        shown = pictures.to_srgb(numpy.array([[[0.5, 0.0, 9.0], [numpy.nan, 0.5, 0.5], [numpy.inf, -1.0, 0.001]]]), 1.0)
        numpy.testing.assert_allclose(shown[0], [[0.735357, 0, 1], [1, 0, 1], [1, 0, 0.01292]], atol=1e-6)

    def test_one_method_of_each_kind_is_shown_unless_others_are_asked_for(self):
        found = records.read(self.make_results())
        self.assertEqual(methods.shown_methods(found, [], False, {}), ["PM, radius", "PPM, α = 0.5"])
        self.assertEqual(methods.shown_methods(found, [], False, {"PPM, α = 0.5": 2.0, "PPM, α = 0.9": 1.0}),
                         ["PM, radius", "PPM, α = 0.9"])
        self.assertEqual(methods.shown_methods(found, [0.9], False, {}), ["PM, radius", "PPM, α = 0.9"])
        self.assertEqual(methods.shown_methods(found, [], True, {}), found.labels)

    def test_of_a_kind_the_method_with_the_least_error_at_the_end_is_the_best(self):
        made = [row for alpha, first, last in [("0.5", 0.1, 0.04), ("0.9", 0.2, 0.01)]
                for row in synthetic.rows(lambda seed, number, component: first if number < 64 else last, seeds=[1, 2], alpha=alpha)]
        synthetic.write_csv(self.results, made)
        found = strip.errors_at_end(records.read(self.results), "total")
        self.assertEqual(min(found, key=found.get), "PPM, α = 0.9")

    def test_the_command_writes_both_files(self):
        self.make_results()
        for arguments, name in [([], "strip-cornell-box"),
                                (["--all", "--pass", 1, "--exposure", 2], "strip-cornell-box"),
                                (["--component", "gathered"], "strip-cornell-box-gathered")]:
            self.assert_drawn(self.output_of("strip", *arguments), name)

    def test_without_a_reference_the_images_are_drawn_and_that_is_said(self):
        for reference in [None, "somewhere/else"]:
            self.make_results(reference=reference)
            output = self.output_of("strip")
            self.assertIn("no reference for the whole image", output)
            self.assert_drawn(output, "strip-cornell-box")

    def test_a_pass_or_seed_that_is_not_there_is_said(self):
        self.make_results()
        self.assertIn("no snapshot of pass 7; there are those of 1, 64", self.output_of("strip", "--pass", 7))
        self.assertIn("no snapshots of a run with seed 99", self.output_of("strip", "--seed", 99))

    def test_runs_without_snapshots_are_said(self):
        self.make_results(passes=())
        self.assertIn("cornell-box: nothing to show", self.output_of("strip"))

    def test_a_reference_of_another_size_is_refused(self):
        self.make_results()
        for half in ["half_a", "half_b"]:
            write_exr(self.results / f"reference/box/{half}.exr",
                      grey(1.0, (8, 8)))
        self.assertIn(f"differs in size from {self.results}/reference/box/half_a.exr", self.refusal_of("strip"))


if __name__ == "__main__":
    unittest.main()
