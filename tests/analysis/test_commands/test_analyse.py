"""What `analyse` does of a folder is done once: again where something has changed, and where a file is not as it was written."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from photonlab.typesetting import in_latex
from support import ANALYSIS, synthetic
from support.in_folder import InFolder, run


class Analyse(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.results = Path(folder.name)
        synthetic.write_csv(cls.results, synthetic.rows(lambda seed, number, component: (1 + 0.01 * seed) / max(1, number)) +
                            synthetic.rows(lambda seed, number, component: 0.1 + 0.001 * seed, **synthetic.PM_RADIUS))

    def made(self, *arguments):
        """What a call makes: the files that are new or other than before, and what it says."""
        before = self.times()
        code, output, errors = run(*arguments)
        self.assertEqual((code, errors), (0, ""))
        return {name for name, time in self.times().items() if before.get(name) != time}, output

    def times(self):
        return {str(file.relative_to(self.results)): file.stat().st_mtime_ns for file in self.results.rglob("*") if file.is_file()}

    def test_everything_is_made_once_and_the_answer_is_seen_each_time(self):
        run(self.results)
        for arguments in [(self.results,), ("analyse", self.results)]:
            made, output = self.made(*arguments)
            self.assertEqual(made, set())
            self.assertRegex(output, r"64 passes +PPM +0\.126")
            self.assertNotIn("convergence", output)

    def test_what_is_missing_or_changed_is_made_again_and_nothing_else(self):
        run(self.results)
        (self.results / "figures/convergence-cornell-box.png").unlink()
        made, output = self.made(self.results)
        self.assertEqual(made, {"figures/convergence-cornell-box.png", "figures/convergence-cornell-box.pdf"} | ({"analysis.json"} & made))
        (self.results / "answers.csv").write_text("best\nmine\n")
        (self.results / "report.html").unlink()
        made, _ = self.made(self.results)
        self.assertTrue({"answers.csv", "report.html"} <= made)
        self.assertNotIn("figures/convergence-cornell-box.png", made)

    def test_other_records_make_all_of_it_again(self):
        run(self.results)
        file = self.results / "iterations.csv"
        before = file.read_text()
        self.addCleanup(file.write_text, before)
        file.write_text(before.replace("0.01,", "0.02,"))
        made, _ = self.made(self.results)
        self.assertTrue({"figures/convergence-cornell-box.png", "answers.csv", "report.html"} <= made)

    def test_a_file_of_another_kind_in_place_of_its_own_is_replaced(self):
        run(self.results)
        for text in ["", "[]", '{"schema": 1}', '{"schema": 1, "commands": {"convergence": 5}}', '{"schema": 2, "commands": {}}',
                     '{"schema": 1, "commands": {"convergence": {"made_from": [], "files": [], "said": []}}}']:
            (self.results / "analysis.json").write_text(text)
            made, _ = self.made(self.results)
            self.assertIn("figures/convergence-cornell-box.png", made, text)
            self.assertEqual(json.loads((self.results / "analysis.json").read_text())["schema"], 1)

    def test_another_version_of_the_package_makes_all_of_it_again(self):
        run(self.results)
        with mock.patch("photonlab.analysed.version", return_value="another"):
            made, _ = self.made(self.results)
        self.assertIn("figures/convergence-cornell-box.png", made)

    def test_the_word_figure_may_stand_before_a_figure_alone(self):
        for arguments in [["figure"], ["figure", self.results], ["figure", "report", self.results]]:
            code, _, said = run(*arguments)
            self.assertEqual(code, 2)
            self.assertIn("figure: expected a kind, one of convergence, strip", said)
        run(self.results)
        made, _ = self.made("figure", "convergence", self.results, "--metric", "mse")
        drawn = {f"figures/convergence-cornell-box-mse.{kind}" for kind in ["png", "pdf"]}
        self.assertEqual(made, drawn)
        self.assertEqual(self.made(self.results)[0], {"report.html", "analysis.json"})    # which shows it
        for name in drawn:
            (self.results / name).unlink()


class Installed(InFolder):
    def test_the_package_works_where_it_is_copied_to(self):
        """As `cmake --install` or a Debian package places it: the folder alone, somewhere on Python's path."""
        synthetic.write_csv(self.results / "results", synthetic.rows(lambda seed, number, component: seed / max(1, number)))
        shutil.copytree(ANALYSIS / "photonlab", self.results / "lib/photonlab", ignore=shutil.ignore_patterns("__pycache__"))
        for command in [["-m", "photonlab", "analyse", "results"], ["-c", "import photonlab; print(photonlab.load('results').labels)"]]:
            done = subprocess.run([sys.executable, *command], cwd=self.results, capture_output=True, text=True,
                                  env={**os.environ, "PYTHONPATH": str(self.results / "lib"), "PYTHONDONTWRITEBYTECODE": "1"})
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("PPM", done.stdout)


class Table(InFolder):
    def test_a_table_is_set_without_settings_and_with_three_digits(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda seed, number, component: (1 + 0.01 * seed) / max(1, number)) +
                            synthetic.rows(lambda seed, number, component: 0.1 + 0.001 * seed, **synthetic.PM_RADIUS))
        self.assertIn("answers.csv: cannot be read", self.refusal_of("table"))
        self.output_of("answer")
        lines = self.output_of("table", "--columns", "best", "rmse", "unit").strip().split("\n")
        self.assertEqual(lines[:2], ["| best | rmse | unit |", "| --- | ---: | --- |"])
        self.assertIn("| PPM | 0.127 | passes |", lines)
        latex = self.output_of("table", "--table", "latex", "--columns", "runner_up", "rmse")
        self.assertTrue(latex.startswith("\\begin{tabular}{lr}\n\\toprule\nrunner up & rmse"), latex)
        self.assertIn("lacks the columns nothing", self.refusal_of("table", "--columns", "nothing"))

    def test_what_latex_would_take_for_a_command_is_set_as_it_is(self):
        self.assertEqual(in_latex("PPM, α = 0.7 & 5%_x"), r"PPM, $\alpha$ = 0.7 \& 5\%\_x")

    def test_a_table_of_other_records_is_refused(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 1.0))
        self.output_of("answer")
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 2.0))
        self.assertIn("answers.csv: was not made from the records", self.refusal_of("table"))


if __name__ == "__main__":
    unittest.main()
