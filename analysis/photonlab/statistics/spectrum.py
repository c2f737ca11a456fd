"""Of which frequencies an error is made: photon mapping's blotches and a path tracer's grain can have one MSE, and have not one spectrum.

With the reference's halves A and B, an image x of N pixels and F the discrete Fourier transform, the power at a frequency is

    P(k) = Re[ F(x - A)(k) conj F(x - B)(k) ] / N^2,   a mean over channels,

whose sum over all frequencies is mean((x - A)(x - B)), mse_unbiased, by Parseval's theorem: the reference's own noise is in none of it,
and what is near zero can come out below it. [After the error spectrum of Celarek, Jakob, Wimmer and Lehtinen 2019, "Quantifying the
Error of Light Transport Algorithms", whose power is that of x - r.] It is summed in rings of one cycle an image; the frequency 0, the
bias of the mean, stands apart. Without halves the reference is A and B, and its noise is in the power.

A pixel that is not finite is left out, as it is in the records: its error is 0 and the mean is over the others.
"""

import numpy

NAME = "spectrum.csv"
COLUMNS = ["scene", "component", "method", "pass", "frequency", "power", "power_error", "seeds"]


def rings_of(height, width):
    """The ring of each frequency of an image: cycles along its longer side, rounded; 0 for the mean alone."""
    cycles = numpy.hypot(numpy.fft.fftfreq(height)[:, None], numpy.fft.fftfreq(width)[None, :]) * max(height, width)
    return numpy.rint(cycles).astype(int)


def spectrum(image, half_a, half_b):
    """Power by ring, an array whose sum is mean((image - half_a) * (image - half_b)). Arrays (height, width, channels)."""
    first, second = image - half_a, image - half_b
    finite = (numpy.isfinite(first) & numpy.isfinite(second)).all(axis=2, keepdims=True)
    first, second = (numpy.where(finite, difference, 0.0) for difference in [first, second])
    transformed = [numpy.fft.fft2(difference, axes=(0, 1)) for difference in [first, second]]
    power = (transformed[0] * numpy.conj(transformed[1])).real.mean(axis=2) / (finite.size * max(1, finite.sum()))
    return numpy.bincount(rings_of(*power.shape).ravel(), weights=power.ravel())


def over_seeds(spectra):
    """(mean by ring, its standard error; NaN with one seed)."""
    spectra = numpy.array(spectra)
    error = spectra.std(axis=0, ddof=1) / numpy.sqrt(len(spectra)) if len(spectra) > 1 else numpy.full(spectra.shape[1], numpy.nan)
    return spectra.mean(axis=0), error
