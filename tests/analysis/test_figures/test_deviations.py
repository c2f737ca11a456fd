"""Each deviation has its panel and its line, and what is no deviation is refused."""

import unittest

from photonlab.figures import deviations
from support import synthetic
from support.in_folder import InFolder


class Deviations(InFolder):
    def write(self, *named, columns=deviations.COLUMNS):
        synthetic.write_rows(self.results / "deviations.csv", columns, [
            {column: row[column] for column in columns} for row in (
                {"deviation": name, "quantity": "radiance", "pass": number, "value": 1 + 0.5 / number, "value_error": 0.02, "right": 1,
                 "right_error": 0.01} for name in named for number in [4, 1, 2])])

    def test_says_how_each_ends(self):
        self.write(*deviations.PANELS)
        output = self.output_of("deviations")
        for name in deviations.PANELS:
            self.assertIn(f"{name:12} radiance after 4 passes: 1.125 ± 0.02, right 1 ± 0.01", output)
        self.assert_drawn(output, "deviations")

    def test_draws_what_is_there(self):
        self.write("cosine")
        figure = deviations.draw(deviations.read(self.results / "deviations.csv"))
        self.assertEqual([axes.get_visible() for axes in figure.axes], [False, True, False, False, False, False])

    def test_refuses_what_is_none(self):
        self.write("cosine", "a seventh")
        self.assertIn("a seventh: expected one of emission", self.refusal_of("deviations"))
        self.write("cosine", columns=deviations.COLUMNS[:-1])
        self.assertIn("lacks the columns right_error", self.refusal_of("deviations"))


if __name__ == "__main__":
    unittest.main()
