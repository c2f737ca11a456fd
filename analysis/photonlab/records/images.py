"""Reads the images of a run and its reference, and writes images of what was computed from them.

OpenImageIO reads them: Debian has it for Python (python3-openimageio), and a reference may come from any renderer, in
any of OpenEXR's compressions.
"""

import os

import numpy
import OpenImageIO

from photonlab.records import files, kept_files
from photonlab.records.files import InputError


def read_image(file, check=lambda stream: None):
    """(OpenImageIO's description, pixels in the file's own type: asked for floats, OpenImageIO would scale integers to [0, 1]).
    `check` looks at the file first."""
    with kept_files.opened(file) as stream:
        check(stream)
        if os.fstat(stream.fileno()).st_size == 0:
            raise InputError(f"{file}: cannot be read as an image: it is empty")
        name = descriptor_name(stream.fileno())    # of what was opened, whatever the file is called
        image = OpenImageIO.ImageInput.open(name)
        if image is None:
            said = OpenImageIO.geterror().replace(name, str(file))
            raise InputError(f"{file}: cannot be read as an image: {said}")
        spec = image.spec()
        pixels = image.read_image(spec.format)
        error = image.geterror()
        image.close()
        if pixels is None or error:
            raise InputError(f"{file}: its pixels cannot be read: {error.replace(name, str(file))}")
        return spec, pixels


def write_exr(file, channels, pixels, records):
    """Replaces the file by an OpenEXR image of floats: pixels (height, width, channels) with the channels' names. An attribute says
    the hash of the records that it was made from."""
    spec = OpenImageIO.ImageSpec(pixels.shape[1], pixels.shape[0], len(channels), "float")
    spec.channelnames = channels
    spec.attribute("photonlab.records", records)
    with open(os.memfd_create("exr"), "rb") as memory:    # OpenImageIO wants a name to write to
        name = descriptor_name(memory.fileno())
        output = OpenImageIO.ImageOutput.create("exr")
        if output is None or not (output.open(name, spec) and output.write_image(pixels.astype(numpy.float32)) and
                                  output.close()):
            said = output.geterror() if output else OpenImageIO.geterror()
            raise InputError(f"{file}: cannot be written: {said.replace(name, str(file))}")
        return files.replace_file(file, memory.read())


def descriptor_name(descriptor):
    """A name by which what is open can be opened again."""
    return f"/proc/self/fd/{descriptor}"


def read_channels(file, names):
    """The named channels of an EXR as an array (height, width, channels) of doubles; None when it lacks one."""
    spec, pixels = read_image(file)
    if not set(names) <= set(spec.channelnames):
        return None
    return pixels[:, :, [spec.channelnames.index(name) for name in names]].astype(numpy.float64)


def read_component(file, component, photons_carry_direct=False):
    """Radiance of a component, "total" or a layer's name, as an array (height, width, 3); None when the file does not
    have it. Where photons carry direct light, what they gather is judged against direct + gathered."""
    if component == "total":
        colour = read_channels(file, ["R", "G", "B"])
        if colour is None:
            raise InputError(f"{file}: has no channels R, G, B")
        return colour
    layers = [component]
    if photons_carry_direct and component == "gathered":
        layers.append("direct")
    colours = [read_channels(file, [f"{layer}.{channel}" for channel in "RGB"]) for layer in layers]
    return None if any(colour is None for colour in colours) else sum(colours)


def read_layers(halves_of):
    """{"picture": radiance, and "emission", "direct", "gathered" where all files have all three} of a snapshot or, as the mean
    of its halves, of a reference."""
    layers = {"picture": read_reference(halves_of, "total", False)}
    parts = {layer: read_reference(halves_of, layer, False) for layer in ["emission", "direct", "gathered"]}
    return layers if any(part is None for part in parts.values()) else {**layers, **parts}


def read_reference(halves_of, component, photons_carry_direct):
    """The mean of a reference's halves, which are these files, or the single image; None when there is none or it lacks the
    component."""
    halves = [read_component(file, component, photons_carry_direct) for file in halves_of]
    if not halves or any(half is None for half in halves):
        return None
    require_same_size(halves_of[0], halves[0], halves_of[-1], halves[-1])
    return sum(halves) / len(halves)


def require_same_size(file, image, other_file, other):
    if image.shape[:2] != other.shape[:2]:
        raise InputError(f"{file}: differs in size from {other_file}")
