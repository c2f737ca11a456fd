"""The spectrum of an error sums to its unbiased MSE, tells blotches from grain, and other metrics are those of their definitions."""

import unittest

import numpy

from photonlab.statistics import metrics, spectrum
from support import synthetic
from support.images import write_exr, write_runs
from support.in_folder import InFolder

SHAPE = (24, 40, 3)


def channels(image):
    return {channel: image[:, :, place] for place, channel in enumerate("RGB")}


class Spectrum(unittest.TestCase):
    def setUp(self):
        self.random = numpy.random.default_rng(1)
        self.halves = [1 + 0.1 * self.random.standard_normal(SHAPE) for _ in range(2)]

    def test_it_sums_to_the_unbiased_mse(self):
        for shape in [SHAPE, (1, 1, 3), (7, 5, 3), (64, 2, 3)]:
            image, half_a, half_b = (self.random.standard_normal(shape) for _ in range(3))
            power = spectrum.spectrum(image, half_a, half_b)
            self.assertAlmostEqual(power.sum(), ((image - half_a) * (image - half_b)).mean(), places=12)

    def test_pixels_that_are_not_finite_are_left_out_of_the_mean(self):
        image = 1 + self.random.standard_normal(SHAPE)
        image[3, 4, 1] = numpy.nan
        image[5, 6, 0] = numpy.inf
        kept = numpy.isfinite(image).all(axis=2)
        expected = ((image - self.halves[0]) * (image - self.halves[1]))[kept].mean()
        self.assertAlmostEqual(spectrum.spectrum(image, *self.halves).sum(), expected, places=12)

    def test_a_wave_is_in_its_ring_and_a_shift_of_all_in_the_first(self):
        column = numpy.arange(SHAPE[1])
        wave = numpy.broadcast_to(0.2 * numpy.cos(2 * numpy.pi * 6 * column / SHAPE[1])[None, :, None], SHAPE)
        power = spectrum.spectrum(1.3 + wave, numpy.ones(SHAPE), numpy.ones(SHAPE))
        self.assertAlmostEqual(power[0], 0.09)
        self.assertAlmostEqual(power[6], 0.02)
        self.assertAlmostEqual(power.sum(), 0.11)

    def test_rings_are_cycles_along_the_longer_side(self):
        rings = spectrum.rings_of(24, 40)
        self.assertEqual((rings[0, 0], rings[0, 6], rings[0, -6], rings[3, 0], rings[-3, 4]), (0, 6, 6, 5, 6))
        self.assertEqual((rings == 0).sum(), 1)

    def test_of_one_mse_blotches_are_at_low_frequencies_and_grain_is_at_all(self):
        shape = (64, 64, 3)
        grain = self.random.standard_normal(shape)
        transformed = numpy.fft.fft2(self.random.standard_normal(shape), axes=(0, 1))
        transformed[spectrum.rings_of(64, 64) > 8] = 0
        blotches = numpy.fft.ifft2(transformed, axes=(0, 1)).real
        none = numpy.zeros(shape)
        powers = [spectrum.spectrum(image / numpy.sqrt((image ** 2).mean()), none, none) for image in [grain, blotches]]
        self.assertAlmostEqual(powers[0].sum(), powers[1].sum())
        self.assertLess(powers[0][:9].sum(), 0.1)
        self.assertGreater(powers[1][:9].sum(), 0.99)

    def test_the_reference_s_noise_drops_out(self):
        powers = numpy.mean([spectrum.spectrum(numpy.ones(SHAPE), *(1 + 0.1 * self.random.standard_normal(SHAPE) for _ in range(2)))
                             for _ in range(200)], axis=0)
        # Each pixel's product has a deviation of 0.01; of 2880 values and 200 images the mean's is 1.3e-5.
        self.assertLess(abs(powers.sum()), 6e-5)


class Metrics(unittest.TestCase):
    def test_the_worst_pixels_are_left_out_of_the_trimmed_error(self):
        image = numpy.full((20, 50, 3), 1.1)
        image[3, 4] = 100.0
        none = numpy.ones((20, 50, 3))
        self.assertAlmostEqual(metrics.trimmed_mse(image, none, none), 0.01)
        self.assertGreater(metrics.trimmed_mse(image, none, none, share=0.0), 1)

    def test_psnr_and_ssim_are_those_of_their_definitions(self):
        random = numpy.random.default_rng(2)
        reference = random.random((32, 32, 3))
        psnr, ssim = metrics.on_screen(numpy.clip(reference + 0.1, 0, None), reference)
        self.assertAlmostEqual(psnr, 20.0, places=6)
        self.assertEqual(metrics.on_screen(reference, reference), (numpy.inf, 1.0))
        self.assertLess(metrics.on_screen(random.random((32, 32, 3)), reference)[1], 0.1)
        # Of two constants SSIM is its luminance term alone, (2 x y + c) / (x^2 + y^2 + c), c = 0.01^2.
        flat = metrics.on_screen(numpy.full((32, 32, 3), 0.5), numpy.full((32, 32, 3), 0.4))[1]
        self.assertAlmostEqual(flat, (2 * 0.5 * 0.4 + 1e-4) / (0.25 + 0.16 + 1e-4), places=6)


class Commands(InFolder):
    def test_the_tables_are_those_of_the_pictures(self):
        random = numpy.random.default_rng(3)
        reference = numpy.ones(SHAPE)
        images = {}
        rows = synthetic.rows(lambda *_: 0.0, seeds=[1, 2], passes=[8], width="40", height="24")
        for row in rows:
            image = images.setdefault(row["run"], (1 + 0.1 * random.standard_normal(SHAPE)).astype("float32").astype(float))
            row["mse_unbiased"] = row["mse"] = str(((image - reference) ** 2).mean())
        synthetic.write_csv(self.results, rows)
        write_runs(self.results, images, [8], lambda run, _: channels(images[run]), "reference")
        for half in ["half_a", "half_b"]:
            write_exr(self.results / f"reference/{half}.exr", channels(reference))
        self.assert_drawn(self.output_of("spectrum"), "spectrum-cornell-box")
        mse = sum(float(row["mse"]) for row in rows if row["component"] == "total") / 2
        self.assertAlmostEqual(sum(float(row["power"]) for row in self.table("spectrum.csv")), mse, places=9)
        self.assert_drawn(self.output_of("spectrum", "--at", "0.1"), "spectrum-cornell-box")
        self.output_of("metrics", "--exposure", "0.5")
        row, = self.table("metrics.csv")
        self.assertAlmostEqual(float(row["mse"]), mse, places=9)
        self.assertEqual((row["seeds"], row["exposure"]), ("2", "0.5"))
        self.assertLess(float(row["trimmed_rmse"]), float(row["rmse"]))
        self.assertGreater(float(row["deviation"]), 0)


if __name__ == "__main__":
    unittest.main()
