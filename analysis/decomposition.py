"""Tells bias from variance: what is left of a method's error when its noise is averaged away, and the noise itself.

Input are the sums of images over independent seeds that `photonlab run` keeps for an experiment with
`decomposition = true` (RESULTS/ensembles), in up to 16 groups, and the reference's halves A and B. With group means y_g of
m_g seeds each, G groups, K seeds and their mean xbar:

    variance (of one seed) = mean over pixels and channels of  sum_g m_g (y_g - xbar)^2 / (G - 1)
    squared bias           = mean( (xbar - A)(xbar - B) ) - variance / K
    MSE                    = squared bias + variance,  exactly the mean over seeds of mean( (x - A)(x - B) )

All three are unbiased, so what is near zero can come out below it; the sign is kept. A reference of one image has no halves:
its own noise is then part of the squared bias.

Only inner products of the deviations y_g - (A + B) / 2 enter, so each region needs one G x G matrix a pass, and leaving out
a group costs nothing. Standard errors are those of the jackknife over groups (for groups of unequal size after Busing, Meijer
and van der Leeden 1999, "Delete-m Jackknife for Unequal m"), and of the reference: its noise adds -d (A + B - 2 r) to the squared
bias of a pixel with the deviation d from its mean, whose spread is that of d (A - B), since the halves' noise is as likely to
have either sign; summed over pixels, which are independent. A reference of one image has a noise that is not known, and not in
them. Where a bias is lost in noise they are too large, by a factor of up to the root of 2.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

try:
    import files
    import kept_files
    import numpy
    import pictures
    import records
    import tables
    from files import InputError
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas and OpenImageIO (on Debian: "
          "/usr/bin/python3 with python3-pandas, python3-xxhash and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

QUANTITIES = ["variance", "squared_bias", "mse"]
WHOLE = "image"    # the region of all pixels


@dataclass
class Ensemble:
    """The sums of one point of an experiment: a method with its settings, on a scene."""
    folder: Path
    description: dict    # ensemble.json
    seeds: list          # a list a group
    layers: list         # {layer: array (height, width, 3)} a group: means over its seeds
    judged: dict         # what names its reference: ensemble.json, or better run.json, which says which one it was then

    @property
    def point(self):
        return self.description["point"]

    @property
    def counts(self):
        """Seeds in each group."""
        return numpy.array([len(group) for group in self.seeds], dtype=float)

    def component(self, group, number, component):
        """A group's mean image of a component after pass `number`."""
        layers = self.layers[group]
        parts = {"emission": ["emission"], "direct": [f"pass-{number:06}-direct"],
                 "gathered": [f"pass-{number:06}-gathered"],
                 "total": ["emission", f"pass-{number:06}-direct", f"pass-{number:06}-gathered"]}[component]
        return sum(layers[part] for part in parts)


def read_slot(file, key):
    """(seeds, {layer: mean over them}) of one file of sums. `key` is that of the sums beside it, if they have checksums; None where
    they have none."""
    advice = "remove it and run the experiment again, which makes the runs of its seeds anew"
    spec, pixels = pictures.read_image(file, lambda stream: key and kept_files.require_seal(file, stream, advice))
    if key and str(spec.getattribute("photonlab.key")) != key:
        raise InputError(f"{file}: its sums are of other settings than ensemble.json beside it; run the experiment again")
    seeds = str(spec.getattribute("photonlab.seeds") or "").split()
    if not seeds or not all(seed.isdecimal() and len(seed) < 21 for seed in seeds):
        raise InputError(f"{file}: expected sums of images with the attribute photonlab.seeds")
    places = {}
    for index, name in enumerate(spec.channelnames):
        layer, _, channel = name.rpartition(".")
        if layer:
            places.setdefault(layer, {})[channel] = index
    if not all(set(channels) == set("RGB") for channels in places.values()):
        raise InputError(f"{file}: expected the channels R, G and B of each layer")
    return [int(seed) for seed in seeds], {
        layer: pixels[:, :, [channels[channel] for channel in "RGB"]].astype(numpy.float64) / len(seeds)
        for layer, channels in places.items()}


def are_whole(numbers):
    return isinstance(numbers, list) and all(type(number) is int and number >= 0 for number in numbers)


# What ensemble.json has, and what each must be.
DESCRIPTION = {
    "point": (lambda value: isinstance(value, str), "a name"),
    "scene": (lambda value: isinstance(value, str), "a name"),
    "passes": (lambda value: are_whole(value) and value and len(set(value)) == len(value), "different passes"),
    "regions": (lambda value: isinstance(value, dict) and WHOLE not in value and
                all(are_whole(region) and len(region) == 4 for region in value.values()),
                f"left, top, right, bottom by name, which is not {WHOLE}"),
    "reference": (lambda value: value is None or (isinstance(value, dict) and isinstance(value.get("path"), str)), "a path, or null"),
    "photons_carry_direct": (lambda value: isinstance(value, bool), "true or false"),
}


def read_description(results, folder):
    """ensemble.json, checked."""
    file = folder / "ensemble.json"
    description = kept_files.read_json(file, "run the experiment again, which writes it anew", must_be_checked=results.has_stamps)
    if not isinstance(description, dict):
        raise InputError(f"{file}: is not the description of an ensemble")
    for key, (is_sound, expected) in DESCRIPTION.items():
        if key not in description or not is_sound(description[key]):
            raise InputError(f"{file}: {key}: expected {expected}")
    records.check_reference(file, description)
    if description["point"] != folder.name:
        raise InputError(f"{file}: point: expected the name of its folder")
    return description


def read_ensemble(results, folder):
    description = read_description(results, folder)
    key = description.get("key") if results.has_stamps else None
    seeds, layers = [], []
    for slot in sorted(folder.glob("slot-*.exr")):
        own_seeds, own_layers = read_slot(slot, key)
        expected = {"emission", *(f"pass-{number:06}-{layer}" for number in description["passes"]
                                  for layer in ["direct", "gathered"])}
        if set(own_layers) != expected:
            raise InputError(f"{slot}: expected the layers of the passes in ensemble.json")
        if layers and own_layers["emission"].shape != layers[0]["emission"].shape:
            raise InputError(f"{slot}: is of another size than the sums beside it")
        seeds.append(own_seeds)
        layers.append(own_layers)
    if len(seeds) < 2:
        raise InputError(f"{folder}: expected at least two seeds, found {len(seeds)}")
    all_seeds = [seed for group in seeds for seed in group]
    if len(set(all_seeds)) < len(all_seeds):
        raise InputError(f"{folder}: expected each seed in one slot; move the folder away and run the experiment again, which makes "
                         "its seeds anew")
    return Ensemble(folder, description, seeds, layers, description)


def read_ensembles(results):
    """Ensembles of a results folder, one after another: only one is in memory at a time."""
    folders = sorted((results.folder / "ensembles").glob("*/"))
    if not folders:
        raise InputError(f"{results.folder}: has no ensembles; expected an experiment with decomposition = true")
    for folder in folders:
        yield read_ensemble(results, folder)


def read_halves(ensemble, results, component):
    """[A, B] or [image] of the reference's component; empty where it does not have it or there is no reference."""
    carried = ensemble.description["photons_carry_direct"]
    judge = records.reference_of(results, ensemble.judged)
    if judge is None:
        return []
    if not judge.halves:
        raise InputError(f"{ensemble.folder}: its reference {judge.path} {judge.why_not}; bring it back, or run the experiment again")
    halves = [pictures.read_component(file, component, carried) for file in judge.halves]
    for file, half in zip(judge.halves, halves):
        if half is not None and half.shape != ensemble.layers[0]["emission"].shape:
            raise InputError(f"{ensemble.folder}: its reference is of another size than its images: {file}")
    return halves if all(half is not None for half in halves) else []


def regions_of(ensemble, shape):
    """{name: (slice of rows, slice of columns)}, the whole image first."""
    regions = {WHOLE: (slice(0, shape[0]), slice(0, shape[1]))}
    for name, (left, top, right, bottom) in ensemble.description["regions"].items():
        if not (left < right <= shape[1] and top < bottom <= shape[0]):
            raise InputError(f"{ensemble.folder}: expected the region {name} inside {shape[1]}x{shape[0]} pixels, and not "
                                      "empty")
        regions[name] = (slice(top, bottom), slice(left, right))
    return regions


@dataclass
class Moments:
    """What is needed of a region after a pass: inner products of the groups' deviations from the reference, as means over
    pixels and channels, and the reference's own variance: 0 for a reference of one image, NaN without one, so that what needs
    it becomes NaN. A pixel with a value that is not finite in any of the images is left out, as it is in the records.

    `reference_terms` has a value a pixel of the region, whose spread is that of what the reference's noise there adds to the
    squared bias; 0 where a pixel is left out, or the noise is not known."""
    gram: numpy.ndarray
    counts: numpy.ndarray
    floor: float
    pixels: int
    reference_terms: numpy.ndarray

    def without(self, group):
        kept = numpy.arange(len(self.counts)) != group
        return Moments(self.gram[numpy.ix_(kept, kept)], self.counts[kept], self.floor, self.pixels, self.reference_terms)


def moments_of(ensemble, results, component):
    """{(pass, region): Moments}; empty where the component does not apply."""
    if component == "direct" and ensemble.description["photons_carry_direct"]:
        return {}
    halves = read_halves(ensemble, results, component)
    found = {}
    for number in ensemble.description["passes"]:
        images = numpy.stack([ensemble.component(group, number, component) for group in range(len(ensemble.seeds))])
        mean = sum(halves) / len(halves) if halves else numpy.zeros(images.shape[1:])
        noise = (numpy.full_like(mean, numpy.nan) if not halves else (halves[0] - halves[1]) ** 2 / 4 if len(halves) == 2
                 else numpy.zeros_like(mean))
        deviations = images - mean
        finite = numpy.isfinite(deviations).all(axis=(0, 3))
        of_mean = numpy.tensordot(ensemble.counts / ensemble.counts.sum(), deviations, axes=1)
        terms = (of_mean * (halves[0] - halves[1])).mean(axis=2) if len(halves) == 2 else numpy.zeros(mean.shape[:2])
        terms = numpy.where(finite, terms, 0)
        for name, place in regions_of(ensemble, mean.shape).items():
            kept = finite[place]
            flat = deviations[(slice(None), *place)][:, kept].reshape(len(deviations), -1)
            if flat.shape[1]:
                found[number, name] = Moments(flat @ flat.T / flat.shape[1], ensemble.counts,
                                              float(noise[place][kept].mean()), int(kept.sum()),
                                              terms[place].ravel() / kept.sum())
    return found


def decompose(moments):
    """(variance, squared bias, MSE)."""
    counts, gram = moments.counts, moments.gram
    seeds = counts.sum()
    weights = counts / seeds
    of_mean = weights @ gram @ weights
    variance = (counts @ numpy.diag(gram) - seeds * of_mean) / (len(counts) - 1)
    squared_bias = of_mean - moments.floor - variance / seeds
    return numpy.array([variance, squared_bias, squared_bias + variance])


def replicates(moments, estimate=decompose):
    """The estimate without each group in turn, a row a group. NaN with fewer than three groups."""
    if len(moments.counts) < 3:
        return numpy.full((len(moments.counts), len(QUANTITIES)), numpy.nan)
    return numpy.array([estimate(moments.without(group)) for group in range(len(moments.counts))])


def jackknife_error(estimate, without, counts):
    """Standard error of an estimate from its replicates. [Busing et al. 1999, equations 8 and 9]"""
    shares = counts.sum() / counts
    shape = (-1,) + (1,) * (without.ndim - 1)
    shares = shares.reshape(shape)
    groups = len(counts)
    combined = groups * estimate - ((1 - 1 / shares) * without).sum(axis=0)
    pseudo = shares * estimate - (shares - 1) * without
    return numpy.sqrt(((pseudo - combined) ** 2 / (shares - 1)).mean(axis=0))


def standard_errors(moments):
    """Of decompose(): over the seeds by the jackknife, and of the reference."""
    seeds = jackknife_error(decompose(moments), replicates(moments), moments.counts)
    reference = numpy.linalg.norm(moments.reference_terms)
    return numpy.hypot(seeds, [0, reference, reference])


COLUMNS = ["experiment", "scene", "point", *records.TABLE_SETTINGS, "pass", "component", "region", "pixels", "seeds", "groups",
           "paths_emitted", "seconds", "variance", "variance_error", "squared_bias", "squared_bias_error", "mse", "mse_error",
           "reference_floor"]


def point_of(run):
    """A run's name without its seed."""
    return run.rpartition("_seed-")[0]


def rows_of(ensemble, results):
    """The records of a point's runs; None for a point that the experiment does not have any more."""
    rows = results.rows[results.rows["run"].map(point_of) == ensemble.point]
    if rows.empty:
        print(f"{ensemble.folder}: has no runs in iterations.csv; left out")
        return None
    summed = {seed for group in ensemble.seeds for seed in group}
    if not set(rows["seed"].astype(int)) <= summed:
        raise InputError(f"{ensemble.folder}: lacks seeds that iterations.csv has; run the experiment again")
    for run in rows["run"].unique():
        if not results.has_stamps and not results.has_run(run):
            continue
        ensemble.judged = results.run(run).description
        named = ensemble.judged.get("ensemble")
        if results.has_stamps and not (isinstance(named, dict) and named.get("key") == ensemble.description.get("key")):
            raise InputError(f"{ensemble.folder}: holds sums of other settings than run {run}; run the experiment again")
    return rows


def text(number):
    return repr(float(number)) if numpy.isfinite(number) else ""


def table_of(ensemble, results, own):
    """The rows of decomposition.csv for one point; `own` are its records."""
    first = own.iloc[0]
    has_halves = len(read_halves(ensemble, results, "total")) == 2
    table = []
    for component in records.COMPONENTS:
        for (number, region), moments in moments_of(ensemble, results, component).items():
            values = decompose(moments)
            errors = standard_errors(moments)
            of_pass = own[(own["pass"] == number) & (own["component"] == component)]
            paths = pandas_mean(of_pass["paths_emitted"])
            table.append({
                "experiment": first["experiment"], "scene": first["scene"], "point": ensemble.point,
                **records.table_settings(own), "pass": number, "component": component,
                "region": region, "pixels": moments.pixels, "seeds": int(moments.counts.sum()),
                "groups": len(moments.counts), "paths_emitted": paths, "seconds": repr(float(of_pass["seconds"].mean())),
                "reference_floor": repr(moments.floor) if has_halves else "",
                **{name: text(value) for name, value in zip(QUANTITIES, values)},
                **{f"{name}_error": text(error) for name, error in zip(QUANTITIES, errors)}})
    return table


def pandas_mean(texts):
    """Mean of a column that is kept as text; empty where nothing is written."""
    numbers = [float(text) for text in texts if text]
    return repr(sum(numbers) / len(numbers)) if numbers else ""


def pass_of_images(ensemble, wanted):
    """The pass that was asked for, or the last."""
    passes = ensemble.description["passes"]
    if wanted is not None and wanted not in passes:
        raise InputError(f"{ensemble.folder}: pass {wanted} was not recorded; expected one of "
                                  f"{', '.join(map(str, sorted(passes)))} for --images")
    return max(passes) if wanted is None else wanted


def write_images(ensemble, results, number):
    """RESULTS/decomposition/POINT/pass-N.exr: layers `bias` (signed) and `variance` (of one seed), a value a pixel and
    channel; R, G, B are the bias. Returns the file, or None without a reference."""
    halves = read_halves(ensemble, results, "total")
    if not halves:
        return None
    counts = ensemble.counts
    images = numpy.stack([ensemble.component(group, number, "total") for group in range(len(counts))])
    mean = numpy.tensordot(counts / counts.sum(), images, axes=1)
    variance = numpy.tensordot(counts, (images - mean) ** 2, axes=1) / (len(counts) - 1)
    bias = mean - sum(halves) / len(halves)
    file = results.folder / "decomposition" / ensemble.point / f"pass-{number:06}.exr"
    return pictures.write_exr(file, [f"{prefix}{channel}" for prefix in ["", "bias.", "variance."] for channel in "RGB"],
                              numpy.concatenate([bias, bias, variance], axis=2), results.hash)


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/decomposition.csv and, of one pass, images of bias "
                                     "and variance\nin RESULTS_DIR/decomposition/.\n\n" + __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    parser.add_argument("--images", type=int, metavar="PASS", help="the recorded pass whose images are written (default: the "
                        "last)")
    options = parser.parse_args(arguments)
    results = records.read(options.results)
    table = []
    for ensemble in read_ensembles(results):
        own = rows_of(ensemble, results)
        if own is None:
            continue
        table += table_of(ensemble, results, own)
        write_images(ensemble, results, pass_of_images(ensemble, options.images))
    print(tables.write_derived(results, "decomposition.csv", COLUMNS, table))
    return 0


if __name__ == "__main__":
    files.run(main)
