"""The report is one file with nothing to load, and its tables hold the records' numbers."""

import base64
import html
import html.parser
import json
import re
import unittest
import zlib

import numpy
from matplotlib import pyplot

from photonlab.drawing import pictures
from photonlab.records.columns import before_descriptions
from photonlab.report import page
from photonlab.report.viewer import encoded
from support import synthetic
from support.images import grey, write_exr
from support.in_folder import InFolder, run
from test_report.made_up import NASTY, make_results, write_derived, write_figure


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
        columns = ["scene", "point", "method", *before_descriptions().settings, "slope"]
        lines = [",".join({**synthetic.BASE, **settings, "point": "p", "method": method, "slope": slope}[column].replace(",", "")
                          for column in columns)
                 for method, settings, slope in [("PM radius", synthetic.PM_RADIUS, "-0.25"), ("PPM", {"alpha": "0.7"}, "-0.5")]]
        write_derived(self.results, "fits.csv", "\n".join([",".join(columns), *lines]))
        self.assertEqual(self.row_of(self.written_page(), "Fits (fits.csv)", "PM radius"), ["PM radius", "−0.25"])

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

    def test_the_conclusion_comes_first_and_then_the_figures_that_show_it(self):
        make_results(self.results)
        for name in ["other", "equal-time-cornell-box", "convergence-cornell-box", "strip-cornell-box"]:
            write_figure(self.results, f"{name}.png")
        text = html.unescape(self.written_page())
        places = [text.index(part) for part in [
            "cornell-box: PPM has the least RMSE after", "Which method is best: cornell-box", "<figcaption>equal-time-cornell-box.png",
            "<figcaption>convergence-cornell-box.png", 'id="viewer"', "cornell-box: errors of the last pass",
            "<figcaption>other.png", "<h2>How it was made"]]
        self.assertEqual(places, sorted(places))
        self.assertEqual(text.count("<figcaption>equal-time-cornell-box.png"), 1)
        self.assertGreater(text.index("<figcaption>strip-cornell-box.png"), places[5])    # one row of pictures is enough

    def test_the_best_of_each_light_is_marked(self):
        make_results(self.results)
        text = self.written_page()
        marked = re.findall(r'aria-label="([^"]*), the best"', text)
        self.assertEqual(marked, ["0.0158"] * 3)    # of the whole image, direct and gathered light; relMSE is the same for both

    def test_warnings_are_about_something(self):
        make_results(self.results)
        self.assertNotIn('id="warnings"', self.written_page())
        make_results(self.results, change=lambda row: row.update(
            nonfinite="3" if row["mode"] else "0", reference_floor="1",
            seconds=str(float(row["seconds"]) * (3 if row["seed"] == "2" and row["mode"] else 1))))
        for place, file in enumerate(sorted(self.results.glob("runs/*/run.json"))):
            record = json.loads(file.read_text())
            record["reference"]["check"] = {"verdict": "disputed", "why": "photons find <more>."}
            file.write_text(json.dumps({**record, "program": {"commit": f"c{place}"}, "counters": {"paths_cut": 2}}))
        text = html.unescape(self.written_page())
        for expected in ["its reference reference/box is disputed: photons find <more>.", "PM, radius has up to 3 pixels",
                         "the reference's own noise, RMSE 1.0, is more than the error of PPM, 0.016",
                         "the seconds of PM, radius differ from seed to seed by 71%", "of 4 versions of the program",
                         "8 light paths were cut"]:
            self.assertIn(expected, text)
        self.assertNotIn("the seconds of PPM", text)

    def test_a_table_that_is_none_is_refused(self):
        make_results(self.results)
        (self.results / "fits.csv").write_text("a,b\n1\n")
        self.assertIn("fits.csv:2: has 1 fields", self.refusal_of("report"))

    def test_a_reference_of_another_size_is_refused(self):
        make_results(self.results)
        for half in ["half_a", "half_b"]:
            write_exr(self.results / f"reference/box/{half}.exr", grey(1.0, (8, 8)))
        self.assertIn("half_a.exr: differs in size from", self.refusal_of("report"))

    def test_eight_stops_of_exposure_show_the_same_picture_as_doubles(self):
        image = 2.0 ** numpy.linspace(-12, 6, 64 * 64 * 3).reshape(64, 64, 3)
        packed = numpy.frombuffer(zlib.decompress(base64.b64decode(encoded(image, 1.0))), numpy.uint8)
        halves = packed.reshape(2, -1).T.copy().view("<f2").reshape(3, 64, 64).transpose(1, 2, 0).astype(float)
        for stops in [-8, 0, 8]:
            numpy.testing.assert_allclose(pictures.to_srgb(halves, 2.0 ** stops), pictures.to_srgb(image, 2.0 ** stops),
                                          atol=0.15 / 255)


if __name__ == "__main__":
    unittest.main()
