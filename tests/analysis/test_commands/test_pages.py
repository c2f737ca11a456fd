"""What pages say to type is understood: every command of the analysis that a page names exists, and its arguments can be read. A
page with pictures names something that draws: a command of the analysis, of the program, or a script."""

import contextlib
import io
import re
import shlex
import unittest

from photonlab import command, command_line
from support import ROOT

PAGES = [ROOT / "README.md", ROOT / "analysis/README.md", *sorted((ROOT / "docs").rglob("*.md"))]
# In a block of code or in `back quotes`: of Python, or of the program where it starts the analysis.
CALL = re.compile(r"(?:/usr/bin/python3 analysis|\bphotonlab (?=figure|analyse))(?P<arguments>[^`#\n]*)")
MAKERS = re.compile(r"/usr/bin/python3 (analysis|docs|tests)|\./demo|photonlab (compare|render|figure|analyse)|tests/cluster/scale\.py --draw|scenes/survey\.py")
PLACEHOLDER = re.compile(r"\b(KIND|COMMAND|RESULTS|OPTIONS?)\b|\.\.\.")


def calls_of(page):
    """[(line, [argument])] of the calls that can be typed as they stand."""
    found = []
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        for call in CALL.finditer(line):
            arguments = shlex.split(call["arguments"].rstrip(" \\"))
            if arguments and not PLACEHOLDER.search(call["arguments"]):
                found.append((number, arguments))
    return found


def complaint_about(arguments):
    """What the command line has against these arguments; "" where nothing."""
    known = {one.name: one for one in command_line.COMMANDS}
    if arguments[0] in [command_line.FIGURE, command_line.ALL]:
        arguments = arguments[1:]
    if arguments[0] not in known:
        return "" if len(arguments) == 1 and "/" in arguments[0] else f"{arguments[0]}: is no command"
    with contextlib.redirect_stderr(io.StringIO()) as errors:
        try:
            command.options_of(known[arguments[0]], arguments[1:])
        except SystemExit:
            return errors.getvalue()
    return ""


class CommandsOfPages(unittest.TestCase):
    def test_are_understood(self):
        tried = 0
        for page in PAGES:
            for number, arguments in calls_of(page):
                with self.subTest(page=str(page.relative_to(ROOT)), line=number):
                    self.assertEqual(complaint_about(arguments), "")
                tried += 1
        self.assertGreater(tried, 40)

    def test_of_no_such_command_or_option_are_told(self):
        self.assertIn("is no command", complaint_about(["convergances", "results/demo"]))
        self.assertIn("unrecognized", complaint_about(["convergence", "results/demo", "--widht", "84mm"]))

    def test_that_draw_stand_on_each_page_with_pictures(self):
        for page in PAGES:
            text = page.read_text(encoding="utf-8")
            if "](http" not in text and re.search(r"!\[[^\]]*\]\([^)]+\)", text):
                with self.subTest(page=str(page.relative_to(ROOT))):
                    self.assertRegex(text, MAKERS)


if __name__ == "__main__":
    unittest.main()
