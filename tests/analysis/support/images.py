"""Images as the program and others write them."""

import numpy
import OpenImageIO


def write_exr(file, channels, kind="float"):
    """`channels` by name: arrays (height, width)."""
    height, width = next(iter(channels.values())).shape
    spec = OpenImageIO.ImageSpec(width, height, len(channels), kind)
    spec.channelnames = tuple(channels)
    spec.attribute("compression", "zip")
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
