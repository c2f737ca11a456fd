"""Labels and titles fit however long they are, figures have the width that is asked for, and drawing changes nothing outside of them."""

import os
import subprocess
import sys
import unittest
from unittest import mock

import matplotlib
import numpy
from matplotlib import pyplot

from photonlab import figures
from photonlab.drawing import style, text
from photonlab.figures import convergence
from support import ANALYSIS, synthetic, whole_results
from support.images import layered, write_exr, write_runs
from support.in_folder import InFolder, run

LONG = ["photon mapping with a fixed radius of four footprints", "photon-mapping-nearest-120-photons-and-a-disc",
        "progressive, hachisuka, alpha 0.7, epanechnikov kernel", "progressive, knaus-zwicker, two thirds, footprints 4",
        "stochastic progressive with an adaptive first radius", "Vertex_Connection_and_Merging_with_merging_radius_3",
        "path tracing with next event estimation and MIS"]
WIDTH = 84    # millimetres: a column


class Text(unittest.TestCase):
    def test_lines_fit_and_hold_all_of_the_text(self):
        for given in [*LONG, "x" * 90, "a", ""]:
            lines = text.wrapped(given, 0.8, 8)
            self.assertEqual("".join("".join(lines).split()), "".join(given.split()))
            for line in lines:
                self.assertLessEqual(text.width_of(line, 8), 0.8)

    def test_a_line_ends_where_words_do(self):
        self.assertEqual(text.wrapped("photon-mapping-nearest", 0.8, 8), ["photon-", "mapping-", "nearest"])

    def test_a_title_is_made_smaller_and_then_shorter(self):
        self.assertEqual(text.fitted("box", 1.0, 9), ("box", 9))
        shown, size = text.fitted("cornell-spheres", 0.9, 9)
        self.assertEqual(shown, "cornell-spheres")
        self.assertLess(size, 9)
        shown, size = text.fitted("cornell-spheres " * 9, 0.9, 9)
        self.assertTrue(shown.endswith("…"))
        self.assertLessEqual(text.width_of(shown, size), 0.9)


def boxes(figure, texts):
    """Extents on the page of texts that say something, in inches."""
    renderer = figure.canvas.get_renderer()
    return [one.get_window_extent(renderer).transformed(figure.dpi_scale_trans.inverted()) for one in texts if one.get_text().strip()]


class Looks(InFolder):
    def setUp(self):
        super().setUp()
        self.addCleanup(pyplot.close, "all")
        rows = []
        for place, name in enumerate(LONG):
            own = synthetic.rows(lambda seed, number, component: 1e-3 * (1 + place) / max(1, number), seeds=[1, 2],
                                 passes=[0, 1, 8, 64], alpha=str(0.3 + place / 10), map_bytes="1e6", hit_point_bytes="1e5")
            for row in own:
                row.update(run=f"cornell-box_m{place}_seed-{row['seed']}", method=name, paths_emitted=str(1000 * int(row["pass"])),
                           relmse=row["mse"], cpu_seconds=row["seconds"])
            rows += own
        synthetic.write_csv(self.results, rows, [*synthetic.COLUMNS, "method"])
        write_runs(self.results, {row["run"] for row in rows}, [8, 64], lambda _, number: layered(1.0 + 0.1 / number, 0.5), "reference")
        for half in ["half_a", "half_b"]:
            write_exr(self.results / f"reference/{half}.exr", layered(1.0, 0.5))

    def figures(self, **look):
        found = self.read()
        for kind in ["convergence", "strip", "gallery", "equal_time", "equal_error", "memory", "spectrum", "time_to_error"]:
            options = {"all": True} if kind == "strip" else {}
            for name, figure in figures.of(kind, found, **look, **options).items():
                yield name, figure

    def test_with_seven_long_names_nothing_leaves_the_page_or_overprints(self):
        for width in [None, WIDTH]:
            for name, figure in self.figures(width=width):
                if name == "gallery" and width:    # which is as wide as its passes
                    continue
                texts = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts()),
                         *(title for axes in figure.axes for title in [axes.title, axes._left_title, axes._right_title])]
                found = boxes(figure, texts)
                self.assertGreaterEqual(len(found), 3 if name.startswith("memory") else 7, name)
                across, up = figure.get_size_inches()
                for box in found:
                    self.assertTrue(-0.01 <= box.x0 and box.x1 <= across + 0.01 and -0.03 <= box.y0 and box.y1 <= up + 0.01,
                                    (name, width, box))
                for place, box in enumerate(found):
                    for other in found[:place]:
                        overlap = min(box.x1, other.x1) - max(box.x0, other.x0), min(box.y1, other.y1) - max(box.y0, other.y0)
                        self.assertFalse(min(overlap) > 0.02, (name, width, box, other))

    def test_every_name_is_shown_whole(self):
        for name, figure in self.figures(width=WIDTH):
            shown = " ".join([*(text.get_text() for text in figure.texts),
                              *(text.get_text() for legend in figure.legends for text in legend.get_texts())])
            for label in LONG if not name.startswith("memory") else LONG[:1]:
                self.assertIn("".join(label.split()), "".join(shown.split()), name)

    def test_a_figure_has_the_width_that_is_asked_for_in_all_formats_with_and_without_its_caption(self):
        for arguments, caption in [([], ""), (["--no-caption"], "caption: Line: root of the mean")]:
            said = self.output_of("convergence", "--width", "84mm", "--format", "png,pdf", "--methods", "p*", *arguments)
            self.assertIn(caption, said)
            picture = pyplot.imread(self.results / "figures/chosen/convergence-cornell-box.png")
            self.assertAlmostEqual(picture.shape[1] / 300 * 25.4, WIDTH, delta=0.1)
            page = (self.results / "figures/chosen/convergence-cornell-box.pdf").read_bytes()
            box = page.split(b"/MediaBox [")[1].split(b"]")[0].split()
            self.assertAlmostEqual(float(box[2]) / 72 * 25.4, WIDTH, delta=0.1)
            heights = locals().get("heights", []) + [picture.shape[0]]
        self.assertLess(heights[1], heights[0])

    def test_without_colours_methods_have_different_looks(self):
        styles = style.method_styles(self.read())
        looks = {(look["marker"], str(look["linestyle"]), look.get("markerfacecolor")) for look in styles.values()}
        self.assertEqual(len(looks), 7)
        neighbours = list(styles.values())
        for one, other in zip(neighbours, neighbours[1:]):
            self.assertNotEqual(one.get("markerfacecolor"), other.get("markerfacecolor"))

    def test_pgf_without_latex_is_refused_and_says_what_it_wants(self):
        with mock.patch.dict(os.environ, {"PATH": str(self.results)}):
            self.assertIn("--format pgf: ", said := self.refusal_of("memory", "--format", "pgf"))
        self.assertIn("expected LaTeX with PGF", said)
        self.assertFalse((self.results / "figures").exists())

    def test_what_is_drawn_against_and_which_light_are_chosen(self):
        figure = convergence.draw(self.read().scenes()[0], components=["gathered"],
                                  against=["photons", "memory", "passes", "cpu_seconds"])
        self.assertEqual([axes.get_xlabel() for axes in figure.axes], ["light paths emitted", "photon map and hit points (MiB)", "pass",
                                                                       "processor time of all passes so far (s)"])
        line = next(line for line in figure.axes[0].get_lines() if line.get_label() == LONG[0])
        self.assertEqual(list(line.get_xdata()), [1000, 8000, 64000])
        line = next(line for line in figure.axes[1].get_lines() if line.get_label() == LONG[0])
        self.assertAlmostEqual(line.get_xdata()[0], 1.1e6 / 2 ** 20)

    def test_a_style_file_has_the_last_word_and_a_wrong_one_is_refused(self):
        file = self.results / "own.mplstyle"
        file.write_text("font.size: 5\nlegend.fontsize: 4\n")
        figure = next(iter(figures.of("memory", self.read(), style=file).values()))
        self.assertEqual(figure.legends[0].get_texts()[0].get_fontsize(), 4)
        file.write_text("no such thing: 5\n")
        self.assertIn("own.mplstyle:1: \"no such thing\" is no setting", self.refusal_of("memory", "--style", file))
        self.assertIn("none.mplstyle: cannot be read", self.refusal_of("memory", "--style", "none.mplstyle"))

    def test_wrong_options_are_refused(self):
        for arguments in [["--width", "2mm"], ["--width", "wide"], ["--format", "gif"], ["--inset", "1,2,3"]]:
            code, _, said = run("equal_time", self.results, *arguments)
            self.assertEqual(code, 2)
            self.assertIn("expected", said)
        self.assertIn("expected pixels inside the 64x48", self.refusal_of("equal_time", "--inset", "60,10,20,20"))
        self.assertIn("expected one of cornell-box", self.refusal_of("memory", "--scenes", "box"))

    def test_pictures_of_equal_time_and_error_say_their_own_pass_time_and_error(self):
        figure, = figures.of("equal_time", self.read(), at=2.0, inset=[(4, 4, 8, 8), (20, 20, 16, 8)]).values()
        shown = [text.get_text() for text in figure.texts]
        self.assertIn("pass 8, 2.0 s\nRMSE 0.011", shown)    # 8 passes of 0.25 s, and the root of 1e-3 / 8
        self.assertEqual(len(figure.axes), 3 * 8)
        figure, = figures.of("equal_error", self.read(), at=0.004).values()
        shown = [text.get_text() for text in figure.texts]
        self.assertIn("pass 64, 16 s\nRMSE 0.0040", shown)


class Notebook(InFolder):
    def test_neither_the_backend_nor_its_settings_are_changed(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda seed, number, component: 1 / max(1, number)))
        code = ("import sys, matplotlib; sys.path.insert(0, sys.argv[1]); import matplotlib.pyplot as pyplot\n"
                "pyplot.figure(); before = dict(matplotlib.rcParams), matplotlib.get_backend()\n"
                "import photonlab; results = photonlab.load(sys.argv[2])\n"
                "figure = photonlab.figures.convergence.draw(results.scene_named('cornell-box'))\n"
                "print(type(figure).__name__, (dict(matplotlib.rcParams), matplotlib.get_backend()) == before, before[1])")
        done = subprocess.run([sys.executable, "-c", code, ANALYSIS, self.results], capture_output=True, text=True,
                              env={**os.environ, "MPLBACKEND": "svg"})
        self.assertEqual((done.stdout, done.stderr), ("Figure True svg\n", ""))

    def test_the_script_in_docs_runs_as_it_stands_and_writes_nothing(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda seed, number, component: seed / max(1, number), paths_emitted="5",
                                                         map_bytes="5", hit_point_bytes="5"))
        before = sorted(self.results.rglob("*"))
        done = subprocess.run([sys.executable, ANALYSIS.parent / "docs/notebook.py", self.results], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for said in ["seconds are in s", "cornell-box: gathered light alone", "memory-cornell-box of 1 panels", "alone"]:
            self.assertIn(said, done.stdout)
        self.assertEqual(sorted(self.results.rglob("*")), before)

    def test_a_figure_looks_the_same_whatever_is_set_around_it(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda seed, number, component: 1 / max(1, number)))
        scene = self.read().scenes()[0]
        drawn = []
        for around in [{}, {"font.size": 30, "xtick.labelsize": 40, "axes.facecolor": "red", "lines.linewidth": 9}]:
            with matplotlib.rc_context(around):
                figure = convergence.draw(scene)
            figure.canvas.draw()
            drawn.append(numpy.asarray(figure.canvas.buffer_rgba()).copy())
            pyplot.close(figure)
        numpy.testing.assert_array_equal(*drawn)

    def test_the_frame_is_tidy_and_has_units(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 1.0) + synthetic.rows(lambda *_: 2.0, **synthetic.PM_RADIUS))
        frame = self.read().frame
        self.assertEqual(len(frame), 2 * 4 * 8 * 4)
        self.assertEqual(set(frame[frame["method"] == "PPM"]["alpha"]), {0.7})
        self.assertTrue(frame[frame["method"] == "PM, radius"]["alpha"].isna().all())
        self.assertEqual(list(frame["method"].cat.categories), ["PM, radius", "PPM"])
        self.assertEqual(frame.attrs["units"]["seconds"], "s")

    def test_no_figure_writes_into_the_folder(self):
        whole_results.make(self.results)
        for command in ["decomposition", "fits"]:
            self.output_of(command)
        before = sorted(self.results.rglob("*"))
        commands = {module.COMMAND.name: module.COMMAND for module in figures.MODULES}
        kinds = [name for name in whole_results.COMMANDS if name in commands]
        self.assertGreater(len(kinds), 12)
        for kind in kinds:
            results = self.read() if commands[kind].selects else commands[kind].read(self.results)
            self.assertTrue(figures.of(kind, results), kind)
            pyplot.close("all")
        self.assertEqual(sorted(self.results.rglob("*")), before)

    def test_what_a_figure_cannot_be_asked_for_is_refused(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 1.0))
        for kind, options in [("pie", {}), ("memory", {"colour": "red"})]:
            with self.assertRaisesRegex(Exception, "expected one of|has no option"):
                figures.of(kind, self.read(), **options)




if __name__ == "__main__":
    unittest.main()
