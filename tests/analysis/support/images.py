"""Images as the program and others write them."""

import numpy
import OpenImageIO

from support import synthetic


def write_exr(file, channels, kind="float", attributes=()):
    """`channels` by name: arrays (height, width)."""
    height, width = next(iter(channels.values())).shape
    spec = OpenImageIO.ImageSpec(width, height, len(channels), kind)
    spec.channelnames = tuple(channels)
    for name, value in [("compression", "zip"), *attributes]:
        spec.attribute(name, value)
    file.parent.mkdir(parents=True, exist_ok=True)
    output = OpenImageIO.ImageOutput.create(str(file))
    assert output.open(str(file), spec), output.geterror()
    assert output.write_image(numpy.stack(list(channels.values()), axis=2).astype("float32")), output.geterror()
    output.close()


def layered(gathered, direct):
    """Channels as the program writes them: constant layers and their sum. Red is 1, green 2, blue 3 times the value."""
    ramp = numpy.ones((48, 64)) + numpy.arange(64) / 64
    channels = {}
    for prefix, value in [("", gathered + direct), ("emission.", 0.0), ("direct.", direct), ("gathered.", gathered)]:
        for factor, channel in enumerate("RGB", start=1):
            channels[prefix + channel] = factor * value * ramp
    return channels


def grey(value, shape=(4, 6)):
    """Channels of a picture without layers that is the same everywhere."""
    return {channel: numpy.full(shape, value) for channel in "RGB"}


def write_runs(results, runs, passes, channels_of, reference=None):
    """run.json and snapshots of these passes of runs; `channels_of(run, pass)` are those of each image. `reference` is what run.json
    names, from the folder of results."""
    for name in runs:
        folder = synthetic.write_run(results, name, passes, reference, working_directory=str(results))
        for number in passes:
            write_exr(folder / f"snapshots/pass-{number:06}.exr", channels_of(name, number))
