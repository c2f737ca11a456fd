"""Every command of the analysis ends with one line that names the file, whatever is in place of what it reads, and leaves what was
there when it cannot write."""

import contextlib
import errno
import os
import re
import shutil
import signal
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from matplotlib import pyplot

from support import ANALYSIS, whole_results
from support.in_folder import run

# What each reads of the folder that whole_results makes, beside iterations.csv.
RUN = "runs/cornell-box_default_seed-1"
IMAGES = [f"{RUN}/run.json", f"{RUN}/snapshots/pass-000032.exr", "reference/half_b.exr"]
SUMS = ["ensembles/cornell-box_b/ensemble.json", "ensembles/cornell-box_b/slot-02.exr", "reference/half_a.exr"]
READS = {"convergence": [], "strip": IMAGES, "gallery": IMAGES, "decomposition": SUMS, "fits": SUMS,
         "bias_variance": ["decomposition.csv"], "memory": [], "best_alpha": ["best-alphas.csv"], "regions": ["decomposition.csv"], "grid": IMAGES,
         "equal_time": [*IMAGES[:2], "decomposition.csv"], "equal_error": IMAGES[:2], "spectrum": IMAGES,
         "metrics": IMAGES, "answer": [], "time_to_error": [], "tradeoff": [], "probes": ["probes.csv"], "scaling": [], "deviations": [],
         "relaxation": [],
         "report": [*IMAGES, "fits.csv", "decomposition.csv"]}
FIGURES = {"convergence": ["convergence-cornell-box"], "strip": ["strip-cornell-box"], "gallery": ["gallery"],
           "bias_variance": ["bias-variance-cornell-box"], "memory": ["memory-cornell-box"], "best_alpha": ["best-alpha-cornell-box"],
           "regions": ["regions-cornell-box"],
           "grid": ["grid-cornell-box", "differences-cornell-box"], "equal_time": ["equal-time-cornell-box"],
           "equal_error": ["equal-error-cornell-box"], "spectrum": ["spectrum-cornell-box"],
           "time_to_error": ["time-to-error"], "tradeoff": ["tradeoff-cornell-box"], "probes": ["probes-cornell-box"],
           "scaling": ["scaling"], "deviations": ["deviations"], "relaxation": ["relaxation"]}
TABLES = {"decomposition": ["decomposition.csv"], "fits": ["fits.csv", "best-alphas.csv"], "equal_time": ["equal-time.csv"],
          "spectrum": ["spectrum.csv"], "metrics": ["metrics.csv"], "answer": ["answers.csv"],
          "time_to_error": ["time-to-error.csv"], "tradeoff": ["tradeoff.csv", "tradeoff.md"], "report": ["report.html"]}
WAITED_TOO_LONG = 60    # seconds


def contents(folder):
    """{name: bytes} of all that a folder holds."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.results = Path(cls.folder.name) / "results"
        whole_results.make(cls.results)
        whole_results.make_extremes(Path(cls.folder.name) / "extremes", Path(cls.folder.name) / "extremes-rays")
        cls.opened = []    # for writing
        sys.addaudithook(cls.note)
        cls.said = {}    # what each command names
        for name in whole_results.COMMANDS:
            code, cls.said[name], errors = run(name, cls.results)
            assert (code, errors) == (0, ""), (name, errors)
        cls.written, cls.opened = cls.opened, None

    @classmethod
    def note(cls, event, arguments):
        if event == "open" and cls.opened is not None and isinstance(arguments[0], (str, bytes, os.PathLike)):
            if (arguments[2] or 0) & (os.O_WRONLY | os.O_RDWR):
                cls.opened.append(os.fsdecode(arguments[0]))

    def test_each_names_what_it_has_written(self):
        for name, said in self.said.items():
            figures = [f"figures/{figure}.{kind}" for figure in FIGURES.get(name, []) for kind in ["png", "pdf"]]
            for file in figures + TABLES.get(name, []):
                self.assertIn(str(self.results / file), said)
                self.assertTrue((self.results / file).is_file(), file)

    def test_without_a_command_all_is_drawn_to_the_same_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            results = Path(folder)
            whole_results.make(results)
            code, output, errors = run(results)
            self.assertEqual((code, errors), (0, ""))
            self.assertIn(str(results / "report.html"), output)
            drawn, expected = contents(results), contents(self.results)
            self.assertEqual(set(drawn) - {"analysis.json"}, set(expected))
            for name, data in expected.items():
                if name.endswith((".png", ".csv")):
                    self.assertEqual(drawn[name], data, name)

    def test_help_and_the_page_list_the_commands_and_help_says_what_each_writes(self):
        code, listed, _ = run("--help")
        self.assertEqual(code, 0)
        page = (ANALYSIS / "README.md").read_text(encoding="utf-8")
        for name in [*whole_results.COMMANDS, "extremes"]:
            summary = re.search(rf"\n  {name} +(.*)\n", listed)[1]
            self.assertIn(f"| `{name}` | {summary} |", page)
            code, output, _ = run(name, "--help")
            self.assertEqual(code, 0)
            for file in FIGURES.get(name, []):
                self.assertIn(f"{file.replace('cornell-box', 'SCENE')}", " ".join(output.split()), name)

    def test_no_folder_and_one_without_records_are_refused(self):
        self.assertEqual(run()[0], 2)
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(run(folder)[::2], (2, f"{folder}/iterations.csv: is not there; expected the records of `photonlab run`\n"))

    def calls(self):
        """(name, folders) of every command."""
        for name in whole_results.COMMANDS:
            yield name, [self.results]
        yield "extremes", [self.results.parent / "extremes", self.results.parent / "extremes-rays"]

    def refusal(self, name, arguments):
        """What a command says that is to end with 2, in one line and before long."""
        def give_up(*_):
            raise AssertionError(f"{name} waits")
        before = signal.signal(signal.SIGALRM, give_up)
        signal.alarm(WAITED_TOO_LONG)
        try:
            code, _, errors = run(name, *arguments)
        finally:
            pyplot.close("all")    # of what was drawn before the refusal
            signal.alarm(0)
            signal.signal(signal.SIGALRM, before)
        self.assertEqual((code, errors.count("\n")), (2, 1), (name, errors))
        return errors

    def test_all_is_written_under_another_name_first(self):
        self.assertGreater(len(self.written), 2 * len(whole_results.COMMANDS))
        for file in self.written:
            self.assertTrue(re.search(r"\.partial-[0-9a-f]{16}$", file) or not file.startswith(str(self.results)), file)
        self.assertEqual([file for file in contents(self.results) if ".partial-" in file], [])

    def test_a_full_disk_is_said_with_the_name_of_the_file_and_leaves_what_was_there(self):
        before = contents(self.results.parent)
        for name, arguments in self.calls():
            with mock.patch("os.fsync", side_effect=OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))):
                said = self.refusal(name, arguments)
            self.assertRegex(said, f"^{self.results.parent}/.*: cannot be written: No space left on device$")
            self.assertEqual(contents(self.results.parent), before, name)

    @contextlib.contextmanager
    def replaced(self, file, put):
        """Something else in place of a file for a while."""
        kept = self.results.parent / "kept"
        file.rename(kept)
        try:
            put(file)
            yield
        finally:
            shutil.rmtree(file) if file.is_dir() and not file.is_symlink() else file.unlink()
            kept.rename(file)

    def test_what_is_no_file_is_refused_by_name(self):
        for put in [os.mkfifo, lambda file: file.symlink_to("/proc/kmsg"), lambda file: file.write_bytes(b"\xff\xfe\x00")]:
            for name, arguments in self.calls():
                first = {"scaling": "scaling.csv", "deviations": "deviations.csv", "relaxation": "relaxation.csv",
                         "best_alpha": "best-alphas.csv"}.get(name, "iterations.csv")
                for file in [first, *READS.get(name, [])]:
                    file = Path(arguments[0]) / file
                    with self.replaced(file, put):
                        self.assertIn(str(file.parent if file.parent.name.startswith("cornell") else file),
                                      self.refusal(name, arguments))

    def test_names_that_are_too_long_or_none_are_refused(self):
        for results in ["x" * 256, "a\0b", "none"]:
            for name, arguments in self.calls():
                self.assertIn(results, self.refusal(name, [results] * len(arguments)))

    def test_a_run_whose_name_no_file_can_have_is_refused(self):
        file = self.results / "iterations.csv"
        for long_run in ["x" * 256 + "_seed-1", "a\0b_seed-1"]:
            changed = file.read_text().replace("cornell-box_default_seed-1", long_run)
            for name in ["strip", "gallery", "grid", "report"]:
                with self.replaced(file, lambda file: file.write_text(changed)):
                    self.assertIn(long_run[:9], self.refusal(name, [self.results]))

    def test_a_folder_whose_name_is_no_text_is_drawn(self):
        odd = self.results.parent / os.fsdecode(b"caf\xe9 $x^$")
        shutil.copytree(self.results, odd)
        for name in whole_results.COMMANDS:
            code, _, errors = run(name, odd)
            self.assertEqual((code, errors), (0, ""), name)
        self.assertEqual(len(contents(odd)), len(contents(self.results)))


if __name__ == "__main__":
    unittest.main()
