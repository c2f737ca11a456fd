"""Turns radiance into what a screen shows."""

import numpy

from photonlab.records import images
from photonlab.statistics import errors


def has_snapshots(results):
    """True where a run has images to show."""
    names = results.rows["run"].unique()
    return any(results.has_run(name) and results.run(name).snapshots for name in names)


def error_text(rows):
    """ "RMSE 0.012" of the records of one run, pass and component; "" where there is no error."""
    if rows.empty or rows["mse"].isna().all():
        return ""
    column = errors.error_column(rows)
    value = rows[column].iloc[0]
    return f"{errors.error_name(column)} {errors.two_digits(errors.root(value))}" if value > 0 else "below resolution"


def caption(rows):
    """ "RMSE 0.012, 3.4 s" of the same."""
    return ", ".join(filter(None, [error_text(rows), f"{errors.two_digits(rows['seconds'].iloc[0])} s"]))


def lit_by_scene(picture, snapshot):
    """A picture with the lights themselves, which a snapshot shows apart, blacked out: what the exposure is chosen for."""
    emission = images.read_component(snapshot, "emission")
    return picture if emission is None else picture * (emission.max(axis=2, keepdims=True) <= 0)


def exposure_for(colour):
    """The factor that makes all but the brightest 3% of the lit pixels fit into what a screen shows."""
    brightest = colour.max(axis=2)
    lit = brightest[numpy.isfinite(brightest) & (brightest > 0)]
    return 1.0 / numpy.percentile(lit, 97) if lit.size else 1.0


def to_srgb(colour, exposure):
    """Display values in [0, 1] by the transfer function of IEC 61966-2-1. A pixel with a NaN is magenta, as in the
    program's own PNGs."""
    shown = colour * exposure
    clipped = numpy.clip(numpy.nan_to_num(shown, nan=0.0), 0.0, 1.0)
    display = numpy.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    display[numpy.isnan(shown).any(axis=2)] = [1.0, 0.0, 1.0]
    return display
