"""The report is one file with nothing to load, its tables hold the records' numbers, and its viewer shows what the EXRs
hold: tested with real keys and mouse moves in a headless Chromium, pixel by pixel against pictures.to_srgb."""

import base64
import html
import html.parser
import json
import subprocess
import sys
import tempfile
import time
import unittest
import zlib
from pathlib import Path

import numpy
from matplotlib import pyplot

from analysis.drawing import pictures, style
from analysis.drawing.saving import RECORDS
from analysis.records import images, records
from analysis.records.columns import before_descriptions
from analysis.report import page
from analysis.report.viewer import encoded
from support import ANALYSIS, browser, synthetic
from support.images import layered, write_exr
from support.in_folder import InFolder, run

NASTY = 'box <img src=x onerror=alert(1)> & "q"'


def make_results(results, scenes=("cornell-box",), passes=(1, 64), reference="reference/box", change=lambda row: None):
    """PM and PPM over two seeds; each scene's, method's and pass's image is another one. Returns the images of the
    least seeds by (scene, method, pass)."""
    made, shown = [], {}
    for place, scene in enumerate(scenes):
        for settings, mse in [(synthetic.PM_RADIUS, 4e-4), ({"alpha": "0.7"}, 1e-4)]:
            own = synthetic.rows(lambda seed, number, component: mse * (1 + seed) if component != "emission" else -1e-9,
                                 seeds=[1, 2], passes=[0, 1, 64], scene=scene, **settings)
            for row in own:
                row["run"] = f"{place}-{settings.get('integrator', 'ppm')}-seed-{row['seed']}"
                row.update(relmse="0.25", paths_emitted=str(50000 * int(row["pass"])), map_bytes=str(3 * 2 ** 20))
                change(row)
            made += own
            for run in sorted({row["run"] for row in own}):
                folder = synthetic.write_run(results, run, passes, reference, working_directory=str(results))
                for number in passes:
                    channels = layered(0.3 + 0.05 * place + 0.02 * len(own[0]["mode"]) + 0.1 / (1 + number) +
                                       0.03 * run.endswith("2"), 0.25)
                    write_exr(folder / f"snapshots/pass-{number:06}.exr", channels)
                    if run.endswith("1"):
                        image = numpy.stack([channels[channel] for channel in "RGB"], axis=2)
                        shown[scene, "PM, radius" if own[0]["mode"] else "PPM", number] = image
    synthetic.write_csv(results, made)
    for half in ["half_a", "half_b"] if reference else []:
        write_exr(results / reference / f"{half}.exr", layered(0.4, 0.25))
    return shown


def write_figure(results, name, of=None):
    """A figure that says that it was made from the records which are there, or from others."""
    (results / "figures").mkdir(exist_ok=True)
    pyplot.imsave(results / "figures" / name, numpy.zeros((4, 4, 3)), metadata={RECORDS: of or records.read(results).hash})


def write_derived(results, name, text):
    """A CSV that says the same."""
    header, *lines = text.strip().split("\n")
    (results / name).write_text("\n".join([f"{header},records", *(f"{line},{records.read(results).hash}" for line in lines)]) + "\n")


class Loads(html.parser.HTMLParser):
    """Collects what a page would fetch, and the texts of its cells."""

    def __init__(self, text):
        super().__init__()
        self.loads, self.cells, self.in_cell = [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.loads += [value for name, value in attributes
                       if name in ["src", "href", "action", "data", "poster", "srcset"]]
        self.in_cell = tag in ["td", "th", "tr"]
        if self.in_cell:
            self.cells.append("")

    def handle_data(self, text):
        if self.in_cell:
            self.cells[-1] += text

    def handle_endtag(self, tag):
        self.in_cell = False


class Page(InFolder):
    def written_page(self):
        self.assertIn(str(self.results / "report.html"), self.output_of("report"))
        return (self.results / "report.html").read_text(encoding="utf-8")

    def rows_of(self, text, caption, method):
        """The cells of a method's rows in the table with this caption."""
        table = text[text.index(caption):]
        rows = []
        for cell in Loads(table[:table.index("</table>")]).cells:    # an empty one is where a row begins
            if not cell.strip():
                rows.append([])
            elif rows:
                rows[-1].append(cell)
        return [row for row in rows if row[:1] == [method]]

    def row_of(self, text, caption, method):
        return self.rows_of(text, caption, method)[0]

    def test_nothing_is_loaded_from_anywhere(self):
        make_results(self.results)
        write_figure(self.results, "curve.png")
        text = self.written_page()
        for address in Loads(text).loads:
            self.assertTrue(address.startswith(("data:", "#")), address[:80])
        self.assertNotRegex(text, r"https?:|@import|url\(")

    def test_tables_hold_the_last_pass_and_the_root_of_the_mean_over_seeds(self):
        make_results(self.results)
        text = self.written_page()
        # Seeds have 2 and 3 times 4e-4 and 1e-4: roots of 1e-3 and 2.5e-4.
        of_light = [["PM, radius", light, "64", "16.0", rmse, "0.250", "–", "–", "–"] for light, rmse in
                    [("whole image", "0.0316"), ("emission", "below resolution"), ("direct", "0.0316"), ("gathered", "0.0316")]]
        self.assertEqual(self.rows_of(text, "cornell-box: errors", "PM, radius"), of_light)
        self.assertEqual(self.row_of(text, "cornell-box: errors", "PPM")[4], "0.0158")
        self.assertEqual(self.row_of(text, "cornell-box: costs", "PPM"),
                         ["PPM", "64", "16.0", "2", "3,200,000", "–", "–", "3.00", "–", "–"])

    def test_a_pass_that_a_seed_lacks_is_not_the_last_one(self):
        def move(row):
            if row["seed"] == "2" and row["pass"] == "64":
                row["pass"] = "32"
        make_results(self.results, change=move)
        self.assertEqual(self.row_of(self.written_page(), "cornell-box: errors", "PPM")[2], "1")

    def test_title_date_program_and_settings_come_from_run_json(self):
        make_results(self.results)
        for file in self.results.glob("runs/*/run.json"):
            record = json.loads(file.read_text())
            record.update(title="Does it <vanish> & why?", started="2026-11-23T14:44:13Z",
                          settings={"alpha": 0.7, "k": None},
                          program={"name": "photonlab", "version": "0.1.0", "commit": "abc"})
            file.write_text(json.dumps(record))
        text = self.written_page()
        for expected in ["<h1>Does it &lt;vanish&gt; &amp; why?</h1>", "2026-11-23", "photonlab 0.1.0 abc",
                         "<dt>settings.alpha</dt><dd>0.7</dd>"]:
            self.assertIn(expected, text)
        self.assertNotIn("settings.k", text)

    def test_figures_are_embedded_with_their_names(self):
        make_results(self.results)
        write_figure(self.results, 'a"b<c>.png')
        text = self.written_page()
        data = base64.b64encode((self.results / 'figures/a"b<c>.png').read_bytes()).decode()
        self.assertIn(f"data:image/png;base64,{data}", text)
        self.assertIn("<figcaption>a&quot;b&lt;c&gt;.png</figcaption>", text)

    def test_names_are_escaped(self):
        make_results(self.results, scenes=[NASTY])
        text = self.written_page()
        self.assertNotIn("<img src=x", text)
        self.assertIn("box &lt;img src=x onerror=alert(1)&gt; &amp; &quot;q&quot;", text)
        self.assertEqual(json.loads(page.inlined("</script><!--")), "</script><!--")
        self.assertNotIn("<", page.inlined("</script><!--"))

    def test_tables_of_other_tools_are_shown_and_the_decomposition_at_its_last_pass(self):
        make_results(self.results)
        write_derived(self.results, "fits.csv", "scene,method,slope\nbox,a<b,-0.6666666\nbox,PPM,0.5\n")
        write_derived(self.results, "decomposition.csv",
                      "scene,point,pass,variance\nbox,PM,1,0.0711\nbox,PM,64,0.0722\nbox,PPM,1,0.0733\nbox,PPM,32,0.0744\n")
        text = self.written_page()
        self.assertEqual(self.row_of(text, "Fits (fits.csv)", "a<b"), ["a<b", "−0.667"])
        self.assertIn("in all rows scene = box", text)
        self.assertIn("the last pass alone", text)
        self.assertEqual([value in text for value in ["0.0711", "0.0722", "0.0733", "0.0744"]],
                         [False, True, False, True])
        self.assertNotIn("best-alphas.csv", text)

    def test_settings_in_tables_of_other_tools_are_named_by_the_method(self):
        make_results(self.results)
        columns = ["scene", "point", *before_descriptions().settings, "slope"]
        lines = [",".join({**synthetic.BASE, **settings, "point": "p", "slope": slope}[column] for column in columns)
                 for settings, slope in [(synthetic.PM_RADIUS, "-0.25"), ({"alpha": "0.7"}, "-0.5")]]
        write_derived(self.results, "fits.csv", "\n".join([",".join(columns), *lines]))
        self.assertEqual(self.row_of(self.written_page(), "Fits (fits.csv)", "PM, radius"), ["PM, radius", "−0.25"])

    def test_what_is_missing_is_said(self):
        make_results(self.results, reference="somewhere/else")
        for file in self.results.glob("somewhere/else/*"):
            file.unlink()
        for file in self.results.glob("runs/0-ppm-seed-*/run.json"):
            record = json.loads(file.read_text())
            file.write_text(json.dumps({**record, "snapshots": []}))
        text = self.written_page()
        self.assertIn("cornell-box: the reference somewhere/else is not there.", text)
        self.assertIn("cornell-box: no snapshots of PPM.", text)
        self.assertIn('id="viewer"', text)

    def test_nothing_is_missing_from_what_has_no_images_and_no_reference(self):
        make_results(self.results, passes=(), reference=None, change=lambda row: row.update(mse="", mse_unbiased=""))
        text = self.written_page()
        self.assertNotIn('id="missing"', text)
        self.assertNotIn('id="viewer"', text)
        self.assertIn("there is no reference, so there are none", text)

    def test_what_was_made_from_other_records_is_named_and_not_shown(self):
        make_results(self.results)
        write_figure(self.results, "new.png")
        write_figure(self.results, "old.png", of="0123456789abcdef" * 2)
        pyplot.imsave(self.results / "figures/unmarked.png", numpy.zeros((4, 4, 3)))
        (self.results / "figures/cut.png").write_bytes((self.results / "figures/new.png").read_bytes()[:40])
        (self.results / "fits.csv").write_text("scene,slope\nbox,0.1234\n")
        write_derived(self.results, "best-alphas.csv", "scene,best_alpha\nbox,0.5678\n")
        text = self.written_page()
        self.assertIn("<figcaption>new.png</figcaption>", text)
        self.assertIn("0.5678", text)
        for stale in ["figures/old.png", "figures/unmarked.png", "figures/cut.png", "fits.csv"]:
            self.assertIn(f"<li>{stale}: was not made from the records that are here now, so it is not shown.</li>", text)
        self.assertNotIn("<figcaption>old.png</figcaption>", text)
        self.assertNotIn("0.1234", text)
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 0.01))    # now all of it is
        text = self.written_page()
        self.assertIn("figures/new.png: was not made", text)
        self.assertNotIn("0.5678", text)

    def test_the_memory_of_a_process_is_a_methods_own_where_it_ran_alone(self):
        make_results(self.results, change=lambda row: row.update(peak_rss_mib="571"))
        for file in self.results.glob("runs/*/run.json"):
            together = 3 if "photonmapper" in str(file) else 1
            file.write_text(json.dumps({**json.loads(file.read_text()), "runs_together": together}))
        text = self.written_page()
        self.assertEqual(self.row_of(text, "cornell-box: costs", "PPM")[-1], "571")
        self.assertEqual(self.row_of(text, "cornell-box: costs", "PM, radius")[-1], "with 2 others")

    def test_errors_are_called_what_they_are(self):
        make_results(self.results)
        self.assertIn("RMSE, without the reference's noise", html.unescape(self.written_page()))
        make_results(self.results, change=lambda row: row.update(mse_unbiased=""))
        self.assertIn("RMSE, with the reference's noise", html.unescape(self.written_page()))

    def test_images_are_of_as_many_seeds_as_asked_for_and_layers_are_kept_once(self):
        make_results(self.results)
        for arguments, seeds in [([], [1, 2]), (["--seeds", "1"], [1])]:
            self.output_of("report", *arguments)
            text = (self.results / "report.html").read_text(encoding="utf-8")
            data = json.loads(text.split('id="data">')[1].split("</script>")[0])
            scene = data["scenes"][0]
            images = [image for image in scene["images"] if image["group"] != "reference"]
            self.assertEqual([[shot["seed"] for shot in image["seeds"]] for image in images], [seeds] * 4)
            # Emission and direct light are the same everywhere; gathered light is another one in each, and the reference's.
            self.assertEqual(len(scene["pixels"]), 2 + 4 * len(seeds) + 1)
            self.assertEqual("Of up to 2 seeds of a method, those of the lowest 1 are here" in text, len(seeds) == 1)
            self.assertNotIn('id="missing"', text)
        self.assertEqual(run("report", self.results, "--seeds", "0")[0], 2)

    def test_records_alone_give_a_page(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 0.01))
        text = self.written_page()
        self.assertIn("No run.json", text)
        self.assertIn("<h1>made-up</h1>", text)

    def test_bad_input_ends_with_2_and_a_message(self):
        self.assertIn("iterations.csv: is not there", self.refusal_of("report"))
        make_results(self.results)
        (self.results / "fits.csv").write_text("a,b\n1\n")
        self.assertIn("fits.csv:2: has 1 fields", self.refusal_of("report"))

    def test_a_reference_of_another_size_is_refused(self):
        make_results(self.results)
        for half in ["half_a", "half_b"]:
            write_exr(self.results / f"reference/box/{half}.exr", {channel: numpy.ones((8, 8)) for channel in "RGB"})
        self.assertIn("half_a.exr: differs in size from", self.refusal_of("report"))

    def test_the_command_runs_from_any_folder(self):
        make_results(self.results)
        done = subprocess.run([sys.executable, ANALYSIS, "report", self.results], cwd="/", capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_eight_stops_of_exposure_show_the_same_picture_as_doubles(self):
        image = 2.0 ** numpy.linspace(-12, 6, 64 * 64 * 3).reshape(64, 64, 3)
        packed = numpy.frombuffer(zlib.decompress(base64.b64decode(encoded(image, 1.0))), numpy.uint8)
        halves = packed.reshape(2, -1).T.copy().view("<f2").reshape(3, 64, 64).transpose(1, 2, 0).astype(float)
        for stops in [-8, 0, 8]:
            numpy.testing.assert_allclose(pictures.to_srgb(halves, 2.0 ** stops), pictures.to_srgb(image, 2.0 ** stops),
                                          atol=0.15 / 255)


@unittest.skipUnless(browser.EXECUTABLE, "no chromium on the PATH (Debian: chromium), so the viewer is not tested")
class Viewer(unittest.TestCase):
    SCENES = ["cornell-box", NASTY]

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.results = Path(folder.name)
        cls.images = make_results(cls.results, scenes=cls.SCENES)
        broken = layered(0.3, 0.25)
        broken["G"][0, 0], broken["R"][0, 1] = numpy.nan, numpy.inf
        write_exr(cls.results / "runs/0-photonmapper-seed-1/snapshots/pass-000001.exr", broken)
        cls.images["cornell-box", "PM, radius", 1] = numpy.stack([broken[channel] for channel in "RGB"], axis=2)
        write_figure(cls.results, "curve.png")
        assert run("report", cls.results)[0] == 0
        halves = [cls.results / f"reference/box/half_{half}.exr" for half in "ab"]
        cls.reference = images.read_reference(halves, "total", False)
        cls.exposure = pictures.exposure_for(cls.reference)
        cls.a = cls.images["cornell-box", "PPM", 64]    # what slot A shows first; B shows the reference
        cls.chromium = browser.Browser()
        cls.addClassCleanup(cls.chromium.close)

    def setUp(self):
        self.chromium.open(self.results / "report.html")
        self.wait_for_legend("A: PPM, pass 64, seed 1 (RMSE 0.014, 16 s)")

    def tearDown(self):
        self.assertEqual(self.chromium.complaints(), [])

    def wait_for_legend(self, text):
        self.chromium.wait_for(f"document.getElementById('legend').textContent === {json.dumps(text)}")

    def pixels(self):
        """What the canvas shows, as an array (height, width, 3) from 0 to 255."""
        data = self.chromium.value("""(() => {
            const canvas = document.querySelector("#picture canvas");
            return Array.from(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data);
        })()""")
        return numpy.array(data).reshape(48, 64, 4)[:, :, :3]

    def assert_pixels(self, expected, atol, area=...):
        """The page decodes an image after it was chosen and draws it when it is ready, so the canvas is given time."""
        deadline = time.monotonic() + browser.TIMEOUT
        while not numpy.allclose(self.pixels()[area], expected, rtol=0, atol=atol) and time.monotonic() < deadline:
            time.sleep(0.02)
        numpy.testing.assert_allclose(self.pixels()[area], expected, rtol=0, atol=atol)

    def assert_shows(self, image, stops=0):
        self.assert_pixels(255 * pictures.to_srgb(image, self.exposure * 2 ** stops), atol=1)

    def selected(self, name):
        return self.chromium.value(f"document.getElementById('{name}').selectedOptions[0].textContent")

    def press(self, selector, *keys):
        self.chromium.focus(selector)
        for key in keys:
            self.chromium.press(key)

    def test_the_page_opens_with_a_method_against_the_reference(self):
        self.assert_shows(self.a)
        self.assertEqual(self.selected("image-b"), "reference")
        self.assertEqual(self.chromium.value("document.images.length"), 1)

    def test_a_stop_of_exposure_doubles_radiance_under_the_srgb_curve(self):
        self.press("#exposure", *["ArrowRight"] * 4)
        self.assert_shows(self.a, stops=1)
        self.press("#exposure", "Home")
        self.assert_shows(self.a, stops=-8)
        self.press("#exposure", "End")
        self.assert_shows(self.a, stops=8)

    def test_space_and_the_button_flip(self):
        self.chromium.move_over("#picture")
        self.chromium.press(" ")
        self.assert_shows(self.reference)
        self.chromium.click("#flip")
        self.assert_shows(self.a)
        # The button has the focus, and the mouse is over the picture: a space is one flip, not two.
        self.chromium.move_over("#picture")
        self.chromium.press(" ")
        self.assert_shows(self.reference)

    def test_a_space_elsewhere_is_not_taken(self):
        self.chromium.move(1, 1)
        self.chromium.press(" ")
        self.assert_shows(self.a)

    def test_the_divider_follows_the_mouse_and_its_slider(self):
        self.chromium.move_over("#picture", 0.25)
        self.chromium.press("w")
        self.chromium.move_over("#picture", 0.5)
        self.assert_shows(numpy.hstack([self.a[:, :32], self.reference[:, 32:]]))
        self.chromium.move_over("#picture", 0.25)
        self.assert_shows(numpy.hstack([self.a[:, :16], self.reference[:, 16:]]))
        self.press("#divider-place", "ArrowRight")
        self.assert_shows(numpy.hstack([self.a[:, :17], self.reference[:, 17:]]))
        self.press("#divider-place", "Home")
        self.assert_shows(self.reference)

    def test_differences_are_signed_or_absolute_and_have_a_gain(self):
        self.chromium.click("input[value=difference]")
        # One is darker than the reference, one brighter.
        for method, number in [("PPM", 64), ("PM, radius", 64)]:
            self.choose("a", f"{method}, pass {number}")
            difference = (self.images["cornell-box", method, number] - self.reference) * self.exposure
            self.assert_signed(difference, gain=16)
            self.press("#gain", "ArrowLeft", "ArrowLeft")
            self.assert_signed(difference, gain=4)
            self.press("#map", "End")
            self.assert_pixels(255 * pictures.to_srgb(numpy.abs(difference), 4), atol=2)
            self.press("#map", "Home")
            self.press("#gain", "ArrowRight", "ArrowRight")

    def assert_signed(self, difference, gain):
        places = numpy.clip(difference.mean(axis=2) * gain, -1, 1) / 2 + 0.5
        colours = pyplot.get_cmap(style.DIFFERENCE_COLOURS)(places, bytes=True)[:, :, :3].astype(int)
        self.assert_pixels(colours, atol=8)    # one of 255 colours to the next

    def choose(self, slot, name):
        """Chooses in a drop-down by arrow keys, as a reader would."""
        self.press(f"#image-{slot}", "Home")
        for _ in range(8):
            if self.selected(f"image-{slot}") == name:
                break
            self.press(f"#image-{slot}", "ArrowDown")
        self.assertEqual(self.selected(f"image-{slot}"), name)
        self.chromium.wait_for(f"document.getElementById('legend').textContent.includes({json.dumps(name)})")

    def test_every_pass_of_every_method_can_be_chosen_in_both_slots(self):
        for (scene, method, number), image in self.images.items():
            if scene == "cornell-box":
                self.choose("a", f"{method}, pass {number}")
                self.assert_shows(image)
        self.chromium.click("#flip")
        self.choose("b", "PPM, pass 1")
        self.assert_shows(self.images["cornell-box", "PPM", 1])

    def layers_of(self, gathered, direct):
        channels = layered(gathered, direct)
        return {layer: numpy.stack([channels[f"{layer}.{channel}"] for channel in "RGB"], axis=2)
                for layer in ["emission", "direct", "gathered"]}

    def choose_layer(self, name):
        self.press("#layer", "Home")
        for _ in range(["picture", "emission", "direct", "gathered"].index(name)):
            self.press("#layer", "ArrowDown")
        self.assertEqual(self.selected("layer"), name)

    def test_each_layer_can_be_chosen_and_is_that_of_both_images(self):
        own, judge = self.layers_of(0.3 + 0.1 / 65, 0.25), self.layers_of(0.4, 0.25)
        for layer, caption in [("direct", " (RMSE 0.014, 16 s)"), ("gathered", " (RMSE 0.014, 16 s)"), ("emission", "")]:
            self.choose_layer(layer)
            self.wait_for_legend(f"A: PPM, pass 64, seed 1, {layer}{caption}")
            self.assert_shows(own[layer])
            self.chromium.click("#flip")
            self.wait_for_legend(f"B: reference, {layer}")
            self.assert_shows(judge[layer])
            self.chromium.click("#flip")
        self.choose_layer("picture")
        self.wait_for_legend("A: PPM, pass 64, seed 1 (RMSE 0.014, 16 s)")
        self.assert_shows(self.a)

    def test_each_seed_can_be_chosen_and_stays_for_another_pass(self):
        self.press("#seed-a", "ArrowDown")
        self.wait_for_legend("A: PPM, pass 64, seed 2 (RMSE 0.017, 16 s)")
        self.assert_shows(sum(self.layers_of(0.33 + 0.1 / 65, 0.25).values()))
        self.choose("a", "PPM, pass 1")
        self.assertEqual(self.selected("seed-a"), "2")
        self.assert_shows(sum(self.layers_of(0.33 + 0.1 / 2, 0.25).values()))
        self.assertEqual(self.selected("seed-b"), "–")
        self.assertTrue(self.chromium.value("document.getElementById('seed-b').disabled"))

    def test_a_pixel_that_is_not_a_number_is_magenta_and_an_infinite_one_is_bright(self):
        self.choose("a", "PM, radius, pass 1")
        self.assert_pixels([255, 0, 255], 0, (0, 0))
        self.assertEqual(self.pixels()[0, 1, 0], 255)
        self.chromium.click("input[value=difference]")
        self.assert_pixels([255, 0, 255], 0, (0, 0))

    def test_another_scene_shows_its_images_under_its_own_name(self):
        self.press("#scene", "End")
        image = self.images[NASTY, "PPM", 64]
        self.assertEqual(self.selected("scene"), NASTY)
        self.wait_for_legend("A: PPM, pass 64, seed 1 (RMSE 0.014, 16 s)")
        self.assert_shows(image)

    def values(self):
        return self.chromium.value("""Array.from(document.querySelectorAll("#values tbody tr"),
            (row) => Array.from(row.cells, (cell) => cell.textContent))""")

    def test_the_radiance_under_the_mouse_is_shown_and_arrow_keys_move_on(self):
        self.chromium.click("#picture")
        self.chromium.move_over("#picture", 16.5 / 64, 12.5 / 48)
        self.assert_close(self.values(), self.a[12, 16], self.reference[12, 16])
        self.chromium.press("ArrowRight")
        self.chromium.press("ArrowDown")
        self.assert_close(self.values(), self.a[13, 17], self.reference[13, 17])
        self.assertEqual(self.chromium.value("document.querySelector('#values caption').textContent"),
                         "Radiance at pixel 17, 13")

    def assert_close(self, shown, a, b):
        numbers = [[float(text.replace("−", "-")) for text in row[1:]] for row in shown]
        self.assertEqual([row[0] for row in shown], ["A", "B", "A − B"])
        numpy.testing.assert_allclose(numbers[:2], [a, b], rtol=0.006)
        numpy.testing.assert_allclose(numbers[2], a - b, atol=0.002)

    def test_zoom_enlarges_in_whole_steps_without_smoothing(self):
        def size():
            return self.chromium.value("""(() => {
                const canvas = document.querySelector("#picture canvas");
                return [canvas.width, canvas.getBoundingClientRect().width, getComputedStyle(canvas).imageRendering];
            })()""")
        self.assertEqual(size(), [64, 512, "pixelated"])
        self.press("#zoom", "ArrowLeft")
        self.assertEqual(size(), [64, 448, "pixelated"])

    def test_a_click_on_a_heading_sorts_by_it(self):
        def methods():
            return self.chromium.value("""Array.from(document.querySelectorAll("#errors table")[1].tBodies[0].rows)
                .filter((row) => row.cells[1].textContent === "whole image").map((row) => row.cells[0].textContent)""")
        self.assertEqual(methods(), ["PM, radius", "PPM"])
        heading = "#errors div:nth-of-type(2) thead tr:last-child th:nth-child(5) button"
        self.chromium.click(heading)
        self.assertEqual(methods(), ["PPM", "PM, radius"])
        self.chromium.click(heading)
        self.assertEqual(methods(), ["PM, radius", "PPM"])

    def test_the_viewer_is_not_printed(self):
        self.addCleanup(self.chromium.call, "Emulation.setEmulatedMedia", media="")
        self.chromium.call("Emulation.setEmulatedMedia", media="print")
        self.assertEqual(self.chromium.value("getComputedStyle(document.getElementById('images')).display"), "none")

    def test_a_layer_that_an_image_does_not_have_is_magenta_and_told(self):
        with tempfile.TemporaryDirectory() as folder:
            make_results(Path(folder))
            for half in "ab":
                channels = {channel: value for channel, value in layered(0.4, 0.25).items() if len(channel) == 1}
                write_exr(Path(folder) / f"reference/box/half_{half}.exr", channels)
            self.assertEqual(run("report", folder)[0], 0)
            self.chromium.open(Path(folder) / "report.html")
            self.wait_for_legend("A: PPM, pass 64, seed 1 (RMSE 0.014, 16 s)")
            self.choose_layer("direct")
            self.chromium.click("#flip")
            self.wait_for_legend("B: reference: has no layer direct")
            self.assert_pixels([255, 0, 255], 0, (20, 20))

    def test_a_page_without_images_works(self):
        with tempfile.TemporaryDirectory() as folder:
            synthetic.write_csv(folder, synthetic.rows(lambda *_: 0.01))
            self.assertEqual(run("report", folder)[0], 0)
            self.chromium.open(Path(folder) / "report.html")
            self.assertEqual(self.chromium.value("document.querySelectorAll('.sortable').length"), 3)


if __name__ == "__main__":
    unittest.main()
