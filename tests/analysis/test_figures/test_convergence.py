"""The convergence plot shows what the records say, and the command behaves."""

import math
import subprocess
import sys
import unittest


from photonlab.drawing import style
from photonlab.figures import convergence
from photonlab.statistics import errors
from support import ANALYSIS, synthetic
from support.in_folder import InFolder


PASSES = [0, 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024]


def power_law(slope, factor=0.01):
    """MSE that falls with the given slope on log-log; pass 0 has an error of its own."""
    return lambda seed, number, component: factor * number ** slope if number else 1.0


class Convergence(InFolder):
    def draw(self, made):
        synthetic.write_csv(self.results, made)
        figure = convergence.draw(self.read())
        if figure:
            self.addCleanup(style.pyplot.close, figure)
        return figure

    def line(self, axes, label):
        return next(line for line in axes.get_lines() if line.get_label() == label)

    def test_a_power_law_is_a_straight_line_of_half_the_slope(self):
        for slope in [-2 / 3, -1.0]:
            figure = self.draw(synthetic.rows(power_law(slope), passes=PASSES))
            x, y = self.line(figure.axes[0], "PPM").get_data()
            self.assertEqual(list(x), PASSES[1:])
            for i in range(len(x) - 1):
                self.assertAlmostEqual(math.log(y[i + 1] / y[i]) / math.log(x[i + 1] / x[i]), slope / 2, places=12)
            self.assertEqual((figure.axes[0].get_xscale(), figure.axes[0].get_yscale()), ("log", "log"))

    def test_the_right_panel_has_the_same_errors_against_seconds(self):
        figure = self.draw(synthetic.rows(power_law(-1), passes=PASSES))
        left, right = (self.line(axes, "PPM").get_data() for axes in figure.axes[:2])
        self.assertEqual(list(left[1]), list(right[1]))
        self.assertEqual(list(right[0]), [0.01 + 0.25 * number for number in PASSES[1:]])

    def test_the_lower_row_is_the_gathered_light_alone(self):
        figure = self.draw(synthetic.rows(lambda seed, number, component: {"gathered": 0.04}.get(component, 0.25)))
        self.assertEqual(len(figure.axes), 4)
        self.assertEqual(set(self.line(figure.axes[0], "PPM").get_ydata()), {0.5})
        self.assertEqual(set(self.line(figure.axes[2], "PPM").get_ydata()), {0.2})

    def test_the_floor_is_drawn_where_it_is_near_and_told_where_it_is_not(self):
        near = self.draw(synthetic.rows(power_law(-1, factor=1e-3), passes=PASSES, floor=4e-6))
        self.assertTrue(any(list(line.get_ydata()) == [0.002, 0.002] for line in near.axes[0].get_lines()))
        far = self.draw(synthetic.rows(power_law(-1, factor=1e3), passes=PASSES, floor=4e-6))
        self.assertFalse(any(list(line.get_ydata()) == [0.002, 0.002] for line in far.axes[0].get_lines()))
        caption = far.texts[0].get_text().replace("\n", " ")
        self.assertIn("below the axis: RMSE 0.0020 (whole image)", caption)

    def test_what_is_below_resolution_is_marked_not_dropped(self):
        figure = self.draw(synthetic.rows(lambda seed, number, component: 0.01 / number - 1e-3 if number else 1.0))
        marks = [line for line in figure.axes[0].get_lines() if line.get_marker() == style.BELOW_MARK["marker"]]
        self.assertEqual([list(mark.get_xdata()) for mark in marks], [[16, 32, 64]])
        self.assertIn("below resolution (≤ 0)", [text.get_text() for text in figure.legends[0].get_texts()])

    def test_every_method_has_a_colour_and_marker_of_its_own(self):
        made = []
        for alpha in range(1, 41):
            made += synthetic.rows(power_law(-1), seeds=[1], passes=[1, 2], alpha=str(alpha / 40))
        figure = self.draw(made)
        looks = {(line.get_color(), line.get_marker()) for line in figure.axes[0].get_lines()
                 if line.get_label().startswith("PPM")}
        self.assertEqual(len(looks), 40)

    def test_the_caption_says_what_line_and_band_are(self):
        several = self.draw(synthetic.rows(power_law(-1)))
        self.assertIn("mean unbiased MSE over 4 seeds; band: least to largest", several.texts[0].get_text())
        one = self.draw(synthetic.rows(power_law(-1), seeds=[1], mse_unbiased=""))
        self.assertIn("one seed", one.texts[0].get_text())

    def test_nothing_is_drawn_without_errors(self):
        made = synthetic.rows(power_law(-1))
        for row in made:
            row.update(mse="", mse_unbiased="", rmse="", reference_floor="")
        self.assertIsNone(self.draw(made))
        output = self.output_of("convergence")
        self.assertIn("cornell-box: no errors were recorded", output)

    def test_the_command_writes_both_files_of_every_scene_from_any_folder(self):
        synthetic.write_csv(self.results, synthetic.rows(power_law(-1)) +
                            synthetic.rows(power_law(-1), scene="glass sphere/2"))
        done = subprocess.run([sys.executable, ANALYSIS, "convergence", self.results], cwd="/", capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assert_drawn(done.stdout, "convergence-cornell-box", "convergence-glass-sphere-2")

    def test_the_same_records_give_the_same_bytes(self):
        synthetic.write_csv(self.results, synthetic.rows(power_law(-1)))
        written = []
        for _ in range(2):
            self.output_of("convergence")
            written.append([file.read_bytes() for file in sorted((self.results / "figures").iterdir())])
        self.assertEqual(written[0], written[1])


class Axes(unittest.TestCase):
    def test_there_are_always_some_labels_and_never_too_many(self):
        for low, ratio in [(0.02, 1.3), (1e-3, 5), (0.9, 80), (3e-7, 1e9), (1, 2000), (0.011, 1.9)]:
            figure, axes = style.pyplot.subplots()
            style.logarithmic(axes.yaxis, low, low * ratio)
            seen = [tick for tick in axes.get_yticks() if low <= tick <= low * ratio]
            self.assertGreaterEqual(len(seen), 2, (low, ratio))
            self.assertLessEqual(len(seen), 8, (low, ratio))
            labels = [style.short_number(tick) for tick in seen]
            self.assertEqual(len(set(labels)), len(labels))
            style.pyplot.close(figure)

    def test_numbers_are_short(self):
        self.assertEqual([style.short_number(value) for value in [0.002, 1, 30, 65536, 1e-6, 2e-6]],
                         ["0.002", "1", "30", "65536", "$10^{-6}$", "$2\\cdot10^{-6}$"])
        self.assertEqual([errors.two_digits(value) for value in [0.002, 0.1349, 12.3]], ["0.0020", "0.13", "12"])

    def test_marks_are_few_and_have_both_ends(self):
        marked = style.marked_places(list(range(1, 1001)))
        self.assertLessEqual(len(marked), 9)
        self.assertEqual((marked[0], marked[-1]), (0, 999))


if __name__ == "__main__":
    unittest.main()
