"""Tests that have a results folder of their own, and commands that are called as the shell would."""

import contextlib
import csv
import io
import tempfile
import unittest
from pathlib import Path

from photonlab import command_line
from photonlab.records import records


def run(*arguments, main=command_line.main):
    """(exit code, standard output, standard error) of the analysis with these arguments."""
    with contextlib.redirect_stdout(io.StringIO()) as output, contextlib.redirect_stderr(io.StringIO()) as errors:
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as end:
            code = end.code
    return code, output.getvalue(), errors.getvalue()


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.results = Path(folder.name)

    def read(self):
        return records.read(self.results)

    def output_of(self, command, *arguments):
        """What a command says that goes well."""
        code, output, errors = run(command, self.results, *arguments)
        self.assertEqual((code, errors), (0, ""))
        return output

    def refusal_of(self, command, *arguments):
        """What a command says that is to end with 2, in one line."""
        code, _, errors = run(command, self.results, *arguments)
        self.assertEqual((code, errors.count("\n")), (2, 1), (command, errors))
        return errors

    def assert_drawn(self, output, *names):
        """Each figure is there as PNG and PDF, and named."""
        for name in names:
            for kind, start in [("png", b"\x89PNG"), ("pdf", b"%PDF")]:
                file = self.results / f"figures/{name}.{kind}"
                self.assertIn(str(file), output)
                self.assertEqual(file.read_bytes()[:4], start)

    def table(self, name):
        """The rows of a table of the folder, as texts by column."""
        with open(self.results / name, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))
