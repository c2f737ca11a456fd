"""The bytes that are drawn are those of the records, and methods with the same bytes are one line."""

import unittest

from photonlab.figures import memory
from support import synthetic
from support.in_folder import InFolder


class Memory(InFolder):
    def write(self, methods):
        """Of `methods`, (settings, bytes of the map by pass and seed)."""
        made = []
        for settings, map_bytes in methods:
            for row in synthetic.rows(lambda *_: 0.01, seeds=[1, 3], passes=[0, 1, 2, 4], **settings):
                row.update(paths_emitted=str(1000 * int(row["pass"])), hit_point_bytes=str(2 ** 20),
                           map_bytes=str(map_bytes(int(row["pass"]), int(row["seed"]))))
                made.append(row)
        synthetic.write_csv(self.results, made)

    def lines(self):
        return memory.lines_of(self.read())

    def test_bytes_are_means_over_seeds_in_mebibytes(self):
        self.write([(synthetic.PM_RADIUS, lambda number, seed: number * seed * 2 ** 20), ({}, lambda number, seed: 2 ** 21)])
        self.assertEqual([(labels, curve.to_dict()) for labels, curve in self.lines()],
                         [(["PM, radius"], {1000: 3, 2000: 5, 4000: 9}), (["PPM"], {1000: 3, 2000: 3, 4000: 3})])

    def test_methods_with_the_same_bytes_share_a_line(self):
        self.write([({"alpha": "0.5"}, lambda *_: 5), ({"alpha": "0.7"}, lambda *_: 6), ({"alpha": "0.9"}, lambda *_: 5)])
        self.assertEqual([labels for labels, _ in self.lines()], [["PPM, α = 0.5", "PPM, α = 0.9"], ["PPM, α = 0.7"]])
        self.assertEqual(memory.shared_name(["PPM, α = 0.5", "PPM, α = 0.9"]), "PPM (2 settings)")
        self.assertEqual(memory.shared_name(["PPM, α = 0.7"]), "PPM, α = 0.7")

    def test_without_photons_there_is_nothing_to_draw(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 0.01, integrator="path"))
        output = self.output_of("memory")
        self.assertIn("cornell-box: no method emits photons", output)


if __name__ == "__main__":
    unittest.main()
