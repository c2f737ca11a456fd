"""Metrics that others report, of the last pass of which all methods have pictures: RMSE and its spread over seeds, RMSE without
fireflies, PSNR and SSIM.

What each is, is said in statistics/metrics.py. PSNR and SSIM are those of the picture on a screen, and depend on the exposure: a factor
on radiance by which all but the brightest 3% of the reference is below white, or that of --exposure; the table says which.
"""

import math

import numpy

from photonlab.command import Command, positive
from photonlab.drawing import pictures
from photonlab.records import records, snapshots, tables
from photonlab.statistics import errors, metrics


def row_of(scene, component, number, label, shown, halves, exposure):
    own = scene.of_method(label)
    own = own[(own["component"] == component) & (own["pass"] == number)]
    squared = own[errors.error_column(own)]
    reference = pictures.to_srgb(sum(halves) / 2, exposure)
    on_screen = numpy.array([metrics.on_screen(pictures.to_srgb(image, exposure), reference) for image in shown])
    spread = on_screen.std(axis=0, ddof=1) / math.sqrt(len(shown)) if len(shown) > 1 else [math.nan, math.nan]
    trimmed = float(numpy.mean([metrics.trimmed_mse(image, *halves) for image in shown]))
    return {"scene": scene.scene, "component": component, "method": label, "pass": number, "seeds": len(shown),
            "rmse": errors.root(squared.mean()), "mse": float(squared.mean()), "deviation": float(squared.std(ddof=1)),
            "trimmed_rmse": errors.root(trimmed), "psnr": float(on_screen[:, 0].mean()), "psnr_error": float(spread[0]),
            "ssim": float(on_screen[:, 1].mean()), "ssim_error": float(spread[1]), "exposure": exposure}


def make(results, options):
    table = []
    for scene in results.scenes():
        number = snapshots.last_common_pass(scene)
        for component in options.components if number else []:
            for label, shown, halves in snapshots.judged_images(scene, component, dict.fromkeys(scene.labels, number)):
                exposure = options.exposure or pictures.exposure_for(sum(halves) / 2)
                table.append(row_of(scene, component, number, label, shown, halves, float(exposure)))
    if not table:
        yield f"{results.folder}: no pictures with a reference at one pass, so no {metrics.NAME}"
        return
    yield tables.Derived(metrics.NAME, metrics.COLUMNS, table)


def add_options(parser):
    parser.add_argument("--components", choices=records.COMPONENTS, nargs="+", default=["total"], help="which light (default: total)")
    parser.add_argument("--exposure", type=positive, metavar="E", help="factor on radiance of PSNR and SSIM")


COMMAND = Command(
    name="metrics", summary="PSNR, SSIM, RMSE without fireflies and spread over seeds, into metrics.csv", about=__doc__,
    writes="metrics.csv", make=make, is_for=pictures.has_snapshots, add_options=add_options)
