"""Adaptive radii beside those of Knaus and Zwicker on planes whose light is known, simulated without the program: what
adaptive_planes_test.cpp expects.

    /usr/bin/python3 tests/statistical/radii/adaptive_planes.py    # a minute: 0.716 0.544 0.438

The rule is that of src/gather/radii/adaptive_radius.h: kappa 6, the Laplacian within two first radii, which shrink with the pass
number to the power -1/10, radii between an eighth of the first and twice as wide.
"""

import numpy

PHOTONS = 2000    # a pass
RUNS = 200
SHOWN = [8, 64, 512]
FIRST_RADII = [0.1, 0.2, 0.4, 0.8]    # the point light is at height 1
KAPPA, BANDWIDTH, SMALLEST, LARGEST = 6, 2, 1 / 8, 2


def point_light(random):
    """Photons of a point light on the plane below it: x and y, a row a run."""
    cosine, angle = 1 - random.random((RUNS, PHOTONS)), 2 * numpy.pi * random.random((RUNS, PHOTONS))
    distance = numpy.sqrt(1 / cosine ** 2 - 1)
    return distance * numpy.cos(angle), distance * numpy.sin(angle)


def patch(random, top=2):
    return 4 * random.random((RUNS, PHOTONS)) - 2, (top + 2) * random.random((RUNS, PHOTONS)) - 2


# Where photons fall, the flux of all in units of irradiance, and the places that are looked at with the irradiance there.
LIGHTS = [(point_light, 2 * numpy.pi, {y: (1 + y * y) ** -1.5 for y in [0, 0.7, 1.5]}),
          (lambda random: patch(random, top=0), 8, {-0.05: 1, -0.15: 1}),    # a straight edge
          (patch, 16, {0: 1})]


def squared_errors(light, flux, place, irradiance, random):
    """{(rule, first radius): mean squared errors after each of SHOWN}."""
    first = numpy.array(FIRST_RADII)[:, None] ** 2    # squared, as all radii here
    mean = {rule: numpy.zeros((len(first), RUNS)) for rule in ["fixed", "adaptive"]}
    square = {rule: first + zeros for rule, zeros in mean.items()}
    laplacian, spread = numpy.zeros_like(mean["fixed"]), numpy.zeros_like(mean["fixed"])
    errors = []
    for number in range(1, SHOWN[-1] + 1):
        x, y = light(random)
        away = x ** 2 + (y - place) ** 2
        looked_at = away < (BANDWIDTH * FIRST_RADII[-1]) ** 2
        near = numpy.sort(numpy.where(looked_at, away, numpy.inf), axis=1)[:, :looked_at.sum(axis=1).max()]
        for rule, radii in square.items():
            count = (near[None] < radii[:, :, None]).sum(axis=2)
            mean[rule] += (flux / PHOTONS * count / (numpy.pi * radii) - mean[rule]) / number
            if rule == "adaptive":
                spread += (count * (flux / PHOTONS / numpy.pi) ** 2 / radii - spread) / number
        band = BANDWIDTH ** 2 * first * number ** -0.2
        inside = near[None] < band[:, :, None]
        count, squares = inside.sum(axis=2), numpy.where(inside, near[None], 0).sum(axis=2)
        found = 24 / (numpy.pi * band ** 2) * (2 * squares / band - count)
        laplacian += (flux / PHOTONS * found - laplacian) / number
        with numpy.errstate(divide="ignore", invalid="ignore"):
            best = numpy.cbrt(spread / (KAPPA / 64 * laplacian ** 2))
        best = numpy.clip(numpy.nan_to_num(best, nan=numpy.inf), first * SMALLEST ** 2, first * LARGEST ** 2)
        square["adaptive"] = numpy.where(spread > 0, best, first) * (number + 1) ** (-1 / 3)
        square["fixed"] = square["fixed"] * (number + 2 / 3) / (number + 1)
        if number in SHOWN:
            errors.append({rule: ((values - irradiance) ** 2).mean(axis=1) for rule, values in mean.items()})
    return errors


def main():
    random = numpy.random.default_rng(7)
    logarithms = [numpy.log(after["adaptive"] / after["fixed"])
                  for light, flux, places in LIGHTS for place, irradiance in places.items()
                  for after in squared_errors(light, flux, place, irradiance, random)]
    by_pass = numpy.array(logarithms).reshape(-1, len(SHOWN), len(FIRST_RADII)).mean(axis=(0, 2))
    print(*(f"{ratio:.3f}" for ratio in numpy.exp(by_pass)))


main()
