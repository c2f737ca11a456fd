"""Writes table.binary, a BRDF in the format of the MERL database, from a formula. Run it in this folder: python3 make_table.py

The measured data may not be redistributed, so the scene comes with this stand-in: a diffuse body under a rough coat,
    f = body (1 - F(theta_d)) / pi + D(theta_h) F(theta_d) V(cos_i, cos_o),
with the distribution D of Walter et al. 2007 (GGX), Schlick's F, and V of the height-correlated Smith shadowing. It depends
on the directions by their half vector alone but for V, so it is reciprocal.

The layout is that of the database's own reader: int32 90, 90, 180; then the planes red, green, blue as float64, little-endian,
each by phi_d + 180 (theta_d + 90 theta_h), theta_h in bins of its square root. A negative number is below the horizon.
"""

import sys

import numpy as np

HALF, DIFFERENCE, AZIMUTH = 90, 90, 180
SCALE = np.array([1.0, 1.15, 1.66]) / 1500.0  # a file's number times this is the BRDF, 1/sr

BODY = np.array([0.38, 0.10, 0.05])
AT_NORMAL = np.array([0.12, 0.10, 0.08])  # Fresnel reflectance
ROUGHNESS = 0.15                          # alpha of GGX


def brdf(theta_h, theta_d, phi_d, body=BODY, at_normal=AT_NORMAL, roughness=ROUGHNESS):
    """f in 1/sr, shape (..., 3); NaN where a direction is below the horizon. Angles in radians, of one shape."""
    along = np.cos(theta_h) * np.cos(theta_d)
    across = np.sin(theta_h) * np.sin(theta_d) * np.cos(phi_d)
    cos_i, cos_o = along - across, along + across
    above = (cos_i > 0) & (cos_o > 0)
    cos_i, cos_o = np.where(above, cos_i, 1.0), np.where(above, cos_o, 1.0)
    a2 = roughness**2
    distribution = a2 / (np.pi * (np.cos(theta_h) ** 2 * (a2 - 1) + 1) ** 2)
    visibility = 0.5 / (cos_o * np.sqrt(a2 + (1 - a2) * cos_i**2) + cos_i * np.sqrt(a2 + (1 - a2) * cos_o**2))
    fresnel = at_normal + (1 - at_normal) * (1 - np.cos(theta_d))[..., None] ** 5
    value = body * (1 - fresnel) / np.pi + (distribution * visibility)[..., None] * fresnel
    return np.where(above[..., None], value, np.nan)


def table(**parameters):
    """The file's numbers, shape (3, 90, 90, 180), at the bins' middles."""
    theta_h = ((np.arange(HALF) + 0.5) / HALF) ** 2 * np.pi / 2
    theta_d = (np.arange(DIFFERENCE) + 0.5) / DIFFERENCE * np.pi / 2
    phi_d = (np.arange(AZIMUTH) + 0.5) / AZIMUTH * np.pi
    numbers = np.moveaxis(brdf(*np.meshgrid(theta_h, theta_d, phi_d, indexing="ij"), **parameters) / SCALE, -1, 0)
    # To 16 bits: the bytes, which a reference's key holds, must not depend on how a machine rounds a sine.
    mantissa, exponent = np.frexp(numbers)
    numbers = np.ldexp(np.round(mantissa * 65536) / 65536, exponent)
    return np.where(np.isnan(numbers), -1.0, numbers)


def write(path, numbers):
    with open(path, "wb") as file:
        file.write(np.array([HALF, DIFFERENCE, AZIMUTH], dtype="<i4").tobytes())
        file.write(np.ascontiguousarray(numbers, dtype="<f8").tobytes())


if __name__ == "__main__":
    write(sys.argv[1] if len(sys.argv) > 1 else "table.binary", table())
