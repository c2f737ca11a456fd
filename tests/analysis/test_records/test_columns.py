"""What the program says of its columns is all that the analysis knows of them: a setting, a metric and an integrator that nobody has
heard of are labelled, drawn and tabled."""

import html
import json
import unittest

import numpy
from matplotlib import pyplot

from photonlab.drawing import style
from photonlab.figures import convergence, grid
from photonlab.records.columns import BEFORE_DESCRIPTIONS
from support import ensembles as made
from support import stamps, synthetic
from support.in_folder import InFolder

WOBBLE = {"name": "wobble", "kind": "setting", "type": "number", "label": "wobble", "unit": "furlongs", "default": "0", "follows": [],
          "values": [], "error": False}
SLACK = {**WOBBLE, "name": "slack", "label": "slack", "follows": ["wobble"]}
MEDIAN = {"name": "median_error", "kind": "measure", "type": "number", "label": "median error", "unit": "radiance", "default": "",
          "follows": [], "values": [], "error": True}


def described():
    """The columns as a program knows them that has the integrator `beams`, before path tracing, two settings and a metric more."""
    listed = json.loads(BEFORE_DESCRIPTIONS.read_text(encoding="utf-8"))["columns"]
    by_name = {column["name"]: column for column in listed}
    by_name["integrator"]["values"].insert(2, ["beams", "photon beams"])
    place = listed.index(by_name["kernel"])
    return [*listed[:place], WOBBLE, SLACK, *listed[place:], MEDIAN]


def rows_of_beams(wobble, error=1e-2, **settings):
    """Rows of the integrator that falls as 1 / n in MSE and in the median error, which is a tenth of it."""
    made_up = synthetic.rows(lambda seed, number, component: error / max(1, number), **{
        "integrator": "beams", "schedule": "", "wobble": wobble, "slack": wobble, **settings})
    return [{**row, "median_error": str(float(row["mse_unbiased"]) / 10)} for row in made_up]


class Described(InFolder):
    def write(self, rows, columns=None, listed=None):
        """A folder with a columns.json; its table has these columns."""
        listed = described() if listed is None else listed
        synthetic.write_csv(self.results, rows, columns or [column["name"] for column in listed])
        stamps.write_with_checksum(self.results / "columns.json", {"schema": 1, "columns": listed})
        return self.read()

    def write_beams(self):
        return self.write(synthetic.rows(lambda *_: 1e-3) + rows_of_beams("0.5") + rows_of_beams("2", 2e-2))


class Unheard(Described):
    def test_labels_name_the_integrator_as_the_program_does_and_the_setting_but_not_what_follows_from_it(self):
        self.assertEqual(self.write_beams().labels, ["PPM", "photon beams, wobble = 0.5", "photon beams, wobble = 2"])

    def test_legends_are_in_the_order_of_the_values_and_each_integrator_has_a_line_of_its_own(self):
        path = synthetic.rows(lambda *_: 1e-3, integrator="path", schedule="", alpha="")
        pm = synthetic.rows(lambda *_: 1e-3, **synthetic.PM_RADIUS)
        found = self.write(path + rows_of_beams("1") + synthetic.rows(lambda *_: 1e-3) + pm)
        self.assertEqual(found.labels, ["PM, radius", "PPM", "photon beams", "path tracing"])
        self.assertEqual(len({str(look["linestyle"]) for look in style.method_styles(found).values()}), 4)

    def test_the_metric_is_drawn_against_passes_under_its_label(self):
        found = self.write_beams()
        figure = convergence.draw(found, "median_error")
        self.addCleanup(pyplot.close, figure)
        axes = figure.axes[0]
        self.assertEqual(axes.get_ylabel(), "median error (radiance)")
        line = next(line for line in axes.get_lines() if line.get_label() == "photon beams, wobble = 0.5")
        self.assertEqual([round(1e-3 / error) for error in line.get_ydata()], [1, 2, 4, 8, 16, 32, 64])
        self.assertIn("mean median error over 4 seeds", figure.texts[0].get_text())
        self.assert_drawn(self.output_of("convergence", "--metric", "median_error"), "convergence-cornell-box-median_error")
        self.assertIn("--metric photons_stored: expected one of mse, ", self.refusal_of("convergence", "--metric", "photons_stored"))

    def test_the_setting_is_an_axis_with_its_unit(self):
        found = self.write([row for wobble in ["0.5", "2"] for alpha in ["0.5", "0.9"] for row in rows_of_beams(wobble, alpha=alpha)])
        figure = grid.draw_heat_map(found, *grid.swept_settings(found))
        self.addCleanup(pyplot.close, figure)
        self.assertEqual({figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()}, {"wobble (furlongs)", "α"})

    def test_the_report_has_all_three_in_its_tables(self):
        self.write_beams()
        self.output_of("report")
        text = html.unescape((self.results / "report.html").read_text(encoding="utf-8")).replace("<wbr>", "")
        table = text[text.index("cornell-box: errors of the last pass"):]
        table = table[:table.index("</table>")]
        self.assertIn("median error</button>", table)
        row = table[table.index("<td>photon beams, wobble = 0.5</td>"):].split("</tr>")[0]
        self.assertIn(">1.56·10⁻⁵</td>", row)    # 1e-2 / 64 / 10

    def test_a_knob_is_what_does_not_follow_from_another(self):
        rows = [{**row, "run": f"cornell-box_{name}_seed-{row['seed']}", "cpu_seconds": row["seconds"]}
                for name, wobble in [("default", "0.5"), ("more", "2")] for row in rows_of_beams(wobble)]
        self.write(rows)
        self.output_of("tradeoff")
        row = next(row for row in self.table("tradeoff.csv") if row["point"] == "more")
        self.assertEqual((row["knob"], row["value"], row["default_value"]), ("wobble", "2", "0.5"))

    def test_tables_have_the_setting(self):
        made.write_ensemble(self.results, "box", [1, 2, 3], lambda n: 0.0, lambda n: 0.1, numpy.random.default_rng(1))
        rows = [{**row, "run": f"box_seed-{row['seed']}"} for row in rows_of_beams("2", seeds=[1, 2, 3], passes=made.PASSES)]
        self.write(rows)
        (self.results / "ensembles/box/ensemble.json").write_text(
            (self.results / "ensembles/box/ensemble.json").read_text().replace('{"path": "reference"}', "null"))
        for command, name in [("decomposition", "decomposition.csv"), ("fits", "fits.csv")]:
            self.output_of(command)
            self.assertEqual({row["wobble"] for row in self.table(name)}, {"2"}, name)


class Old(Described):
    def test_a_folder_without_descriptions_reads_as_it_did(self):
        rows = synthetic.rows(lambda *_: 1e-3, alpha="0.5") + synthetic.rows(lambda *_: 1e-3, alpha="0.9")
        synthetic.write_csv(self.results, rows)
        self.assertEqual(self.read().labels, ["PPM, α = 0.5", "PPM, α = 0.9"])

    def test_a_column_that_is_not_described_is_kept_and_tells_methods_apart_where_it_does(self):
        rows = [{**row, "run": f"box_{drift}_seed-{row['seed']}", "drift": drift} for drift in ["low", "high"]
                for row in rows_of_beams("1")]
        found = self.write(rows, [*(column["name"] for column in described()), "drift"])
        self.assertEqual(set(found.rows["drift"]), {"low", "high"})
        self.assertEqual(found.labels, ["photon beams, drift = high", "photon beams, drift = low"])

    def test_a_table_without_a_column_is_read_as_one_with_its_default(self):
        rows = synthetic.rows(lambda *_: 1e-3) + rows_of_beams("2")
        with_it = self.write([{**row, "wobble": row.get("wobble", "0")} for row in rows])
        self.assertEqual(with_it.labels, ["PPM, wobble = 0", "photon beams, wobble = 2"])
        rows = [row for row in rows if row["integrator"] == "ppm"]
        before = self.write(rows, synthetic.COLUMNS).rows
        after = self.write([{**row, "wobble": "0", "slack": "0"} for row in rows]).rows
        self.assertEqual(before[after.columns].to_csv(), after.to_csv())

    def test_a_default_stands_only_in_rows_of_what_uses_the_setting(self):
        rows = synthetic.rows(lambda *_: 1e-3) + rows_of_beams("", slack="")
        listed = [{**column, "used_by": ["beams"]} if column is WOBBLE else column for column in described()]
        found = self.write(rows, synthetic.COLUMNS, listed)
        self.assertEqual(found.rows.groupby("integrator")["wobble"].unique().map(list).to_dict(), {"beams": ["0"], "ppm": [""]})

    def test_a_folder_that_describes_less_than_there_was_is_drawn(self):
        few = [column for column in described() if column["kind"] == "identity" or column["name"] in [
            "integrator", "wobble", "seconds", "mse", "mse_unbiased", "median_error"]]
        found = self.write(rows_of_beams("1") + rows_of_beams("2"), listed=few)
        self.assertEqual(found.labels, ["photon beams, wobble = 1", "photon beams, wobble = 2"])
        for command in ["convergence", "report", "memory", "equal_time", "time_to_error"]:
            self.output_of(command)


class Descriptions(Described):
    def refused(self, listed, expected):
        stamps.write_with_checksum(self.results / "columns.json", {"schema": 1, "columns": listed})
        self.assertIn(f"columns.json: {expected}", self.refusal_of("convergence"))

    def test_a_description_that_is_none_is_refused_with_its_place(self):
        self.write_beams()
        self.refused("x", "expected \"schema\", 1, and \"columns\", a list")
        self.refused([{"name": "a"}], "column 1: expected an object with name, kind and type")
        self.refused([WOBBLE, WOBBLE], "names a column twice")
        for key, value, expected in [("kind", "knob", "kind: expected one of identity, setting, measure, time"),
                                     ("type", "float", "type: expected one of text, integer, number"), ("label", 1, "label: expected a text"),
                                     ("follows", "alpha", "follows: expected a list of names"),
                                     ("values", [["a"]], "values: expected a list of pairs"), ("error", 1, "error: expected true or false")]:
            self.refused([SLACK, {**WOBBLE, key: value}], f"column 2: {expected}")

    def test_a_description_that_was_changed_is_refused(self):
        self.write_beams()
        file = self.results / "columns.json"
        file.write_text(file.read_text().replace("furlongs", "fathoms"))
        self.assertIn(f"{file}: is not what was written: its checksum is another", self.refusal_of("convergence"))


if __name__ == "__main__":
    unittest.main()
