"""The figure has its clouds and curves, and what is said of them is what is in the records."""

import unittest

from photonlab.figures import relaxation
from support import synthetic
from support.in_folder import InFolder


class Relaxation(InFolder):
    def write(self, columns=relaxation.COLUMNS):
        rows = [{"kind": kind, "stage": stage, "x": x, "y": 0.25 * x} for kind in ["photon", "edge", "counts"]
                for stage in relaxation.STAGES for x in [-1, 1, 2]]
        synthetic.write_rows(self.results / "relaxation.csv", columns, [{name: row[name] for name in columns} for row in rows])

    def test_says_what_is_beyond_the_edge(self):
        self.write()
        output = self.output_of("relaxation")
        self.assertIn("protected  density beyond the edge 0.25 of the bright side's; variance over mean of counts -0.25 (-1), 0.25 (1), "
                      "0.5 (2)", output)
        self.assert_drawn(output, "relaxation")

    def test_refuses_what_is_not_there(self):
        self.write(columns=relaxation.COLUMNS[:-1])
        self.assertIn("lacks the columns y", self.refusal_of("relaxation"))


if __name__ == "__main__":
    unittest.main()
