"""The viewer of the report shows what the EXRs hold: tested with real keys and mouse moves in a headless Chromium, pixel by pixel
against pictures.to_srgb."""

import json
import tempfile
import time
import unittest
from pathlib import Path

import numpy
from matplotlib import pyplot

from photonlab.drawing import pictures, style
from photonlab.records import images
from support import browser, synthetic
from support.images import layered, write_exr
from support.in_folder import run
from test_report.made_up import NASTY, colour_of, make_results, write_figure


def contrast(*colours):
    """The ratio of two colours, "rgb(1, 2, 3)", as WCAG 2 defines it."""
    def luminance(colour):
        shown = numpy.array([float(part) for part in colour[4:-1].split(",")]) / 255
        return numpy.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722]
    dark, light = sorted(map(luminance, colours))
    return (light + 0.05) / (dark + 0.05)


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
        cls.images["cornell-box", "PM, radius", 1] = colour_of(broken)
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
        return {layer: colour_of(channels, f"{layer}.")
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

    def test_number_keys_choose_images_in_the_order_of_the_list(self):
        self.chromium.move_over("#picture")
        self.chromium.press("2")
        self.wait_for_legend("A: PM, radius, pass 64, seed 1 (RMSE 0.028, 16 s)")
        self.assert_shows(self.images["cornell-box", "PM, radius", 64])
        self.chromium.press("3", shift=True)
        self.wait_for_legend("B: PPM, pass 1, seed 1 (RMSE 0.014, 0.26 s)")
        self.assert_shows(self.images["cornell-box", "PPM", 1])
        self.chromium.press("9")    # there are five
        self.assert_shows(self.images["cornell-box", "PPM", 1])

    def test_keys_go_to_the_next_layer_and_seed(self):
        self.chromium.move_over("#picture")
        self.chromium.press("l")
        self.assertEqual(self.selected("layer"), "emission")
        self.chromium.press("s")
        self.wait_for_legend("A: PPM, pass 64, seed 2, emission")
        self.chromium.press("s")
        self.wait_for_legend("A: PPM, pass 64, seed 1, emission")

    def test_the_wheel_zooms_about_the_pixel_under_the_mouse(self):
        def state():
            return self.chromium.value("[Number(document.getElementById('zoom').value), "
                                       "document.querySelector('#values caption').textContent]")
        self.chromium.move_over("#picture", 0.4, 0.4)
        before = state()
        self.chromium.turn_wheel("#picture", -1, 0.4, 0.4)
        self.chromium.wait_for(f"Number(document.getElementById('zoom').value) === {before[0] + 1}")
        self.chromium.turn_wheel("#picture", 1, 0.4, 0.4)
        self.chromium.wait_for(f"Number(document.getElementById('zoom').value) === {before[0]}")

    def test_a_link_brings_back_a_view(self):
        self.press("#scene", "End")
        self.chromium.click("input[value=wipe]")
        self.choose("a", "PM, radius, pass 1")
        self.press("#seed-a", "ArrowDown")
        self.choose("b", "PPM, pass 1")
        self.press("#exposure", "ArrowRight")
        self.choose_layer("gathered")
        self.chromium.move_over("#picture", 16.5 / 64, 12.5 / 48)
        shown = [self.pixels().tolist(), self.chromium.value("document.getElementById('legend').textContent")]
        link = self.chromium.value("document.getElementById('link').getAttribute('href')")
        self.chromium.open(self.results / "report.html")
        self.wait_for_legend("A: PPM, pass 64, seed 1 (RMSE 0.014, 16 s)")
        self.chromium.value(f"location.hash = {json.dumps(link)}")
        self.wait_for_legend(shown[1])
        self.assert_pixels(numpy.array(shown[0]), 0)
        self.assertEqual(self.chromium.value("document.querySelector('#values caption').textContent"), "Radiance at pixel 16, 12")
        self.chromium.value("location.hash = '#view?scene=none&a=none&zoom=x&mode=%22&pixel=a,b'")    # what it has not
        self.chromium.wait_for("document.getElementById('legend').textContent.startsWith('A: PM, radius, pass 1, seed 2')")

    def test_text_can_be_read_in_light_and_in_dark(self):
        self.addCleanup(self.chromium.call, "Emulation.setEmulatedMedia", features=[])
        for scheme in ["light", "dark"]:
            self.chromium.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
            for selector in ["h1", "p.small", "a", "td", "caption span", "figcaption"]:
                colours = self.chromium.value(f"""[getComputedStyle(document.querySelector("{selector}")).color,
                                                   getComputedStyle(document.body).backgroundColor]""")
                self.assertGreater(contrast(*colours), 4.5, (scheme, selector))    # WCAG 2, level AA

    def test_everything_that_can_be_used_has_a_name(self):
        nameless = self.chromium.value("""Array.from(document.querySelectorAll("select, input, button, a, img"))
            .filter((one) => !(one.textContent.trim() || one.alt || one.ariaLabel || one.labels?.[0]?.textContent.trim()))
            .map((one) => one.outerHTML)""")
        self.assertEqual(nameless, [])

    def test_nothing_is_wider_than_a_telephone(self):
        self.addCleanup(self.chromium.call, "Emulation.clearDeviceMetricsOverride")
        self.chromium.call("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
        self.assertLessEqual(self.chromium.value("document.documentElement.scrollWidth"), 390)

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
            self.assertEqual(self.chromium.value("document.querySelectorAll('.sortable').length"), 4)


if __name__ == "__main__":
    unittest.main()
