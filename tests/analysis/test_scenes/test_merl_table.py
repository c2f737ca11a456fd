"""The stand-in for measured data: its layout, and its numbers against the formula in another form."""

import os
import struct
import sys
import tempfile
import unittest

import numpy as np

SCENE = os.path.join(os.path.dirname(__file__), "..", "..", "..", "scenes", "merl")
sys.path.insert(0, SCENE)

import make_table  # noqa: E402


def cook_torrance(out, into, body, at_normal, roughness):
    """The same surface by directions, unit vectors with the normal along z: D F G / (4 cos cos) with Smith's G of heights
    that belong together, by its lambda functions. [Heitz 2014, equations 72 and 99]"""
    half = (out + into) / np.linalg.norm(out + into)
    tangent2 = 1 / half[2] ** 2 - 1
    distribution = 1 / (np.pi * roughness**2 * half[2] ** 4 * (1 + tangent2 / roughness**2) ** 2)
    shadowing = [(np.sqrt(1 + roughness**2 * (1 / v[2] ** 2 - 1)) - 1) / 2 for v in (out, into)]
    fresnel = at_normal + (1 - at_normal) * (1 - half @ out) ** 5
    return body * (1 - fresnel) / np.pi + distribution * fresnel / (1 + sum(shadowing)) / (4 * out[2] * into[2])


def directions(theta_h, theta_d, phi_d):
    """The pair with these angles. [Rusinkiewicz 1998]"""
    difference = np.array([np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d)])
    cosine, sine = np.cos(theta_h), np.sin(theta_h)
    into = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]]) @ difference
    half = np.array([sine, 0, cosine])
    return 2 * (half @ into) * half - into, into


class MakeTable(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.numbers = make_table.table()

    def test_numbers_are_the_formula_at_the_middle_of_their_bin(self):
        random = np.random.default_rng(5)
        below = 0
        for _ in range(2000):
            h, d, a = random.integers(90), random.integers(90), random.integers(180)
            out, into = directions(((h + 0.5) / 90) ** 2 * np.pi / 2, (d + 0.5) / 180 * np.pi, (a + 0.5) / 180 * np.pi)
            found = self.numbers[:, h, d, a]
            if min(out[2], into[2]) <= 0:
                below += 1
                np.testing.assert_array_equal(found, -1)
                continue
            expected = cook_torrance(out, into, make_table.BODY, make_table.AT_NORMAL, make_table.ROUGHNESS)
            np.testing.assert_allclose(found * np.array([1, 1.15, 1.66]) / 1500, expected, rtol=2e-5)
        self.assertGreater(below, 200)

    def test_file_has_the_published_layout(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "table.binary")
            make_table.write(path, self.numbers)
            with open(path, "rb") as file:
                content = file.read()
        self.assertEqual(len(content), 34992012)
        self.assertEqual(struct.unpack_from("<iii", content), (90, 90, 180))
        channel, h, d, a = 2, 31, 12, 170
        place = a + 180 * (d + 90 * h) + channel * 90 * 90 * 180
        self.assertEqual(struct.unpack_from("<d", content, 12 + 8 * place)[0], self.numbers[channel, h, d, a])

    def test_numbers_do_not_depend_on_the_last_bits_of_a_sine(self):
        mantissa, _ = np.frexp(self.numbers[self.numbers > 0])
        np.testing.assert_array_equal(mantissa * 65536, np.round(mantissa * 65536))


if __name__ == "__main__":
    unittest.main()
