"""Metrics that others report, of the last pictures, so that a paper's table can be set beside ours.

    rmse          as everywhere here: the root of the mean over seeds of the squared error, without the reference's noise
    deviation     of the squared error, standard deviation over seeds: how far one render is from the next
    trimmed_rmse  rmse without the 0.1% of the pixels that are farthest off: fireflies hide what the rest does
    psnr, ssim    of the picture that a screen shows: linear radiance times `exposure`, clipped to [0, 1], in sRGB. PSNR in decibels
                  with a peak of 1; SSIM as in Wang, Bovik, Sheikh and Simoncelli 2004, "Image Quality Assessment" (Gaussian window of
                  1.5 pixels), a mean over the channels. Both hold the reference's noise.

PSNR and SSIM are scikit-image's: their conventions (windows, edges, the variance's denominator) are what differs between programs, and
those of a library that others use can be named.
"""

import numpy

NAME = "metrics.csv"
COLUMNS = ["scene", "component", "method", "pass", "seeds", "rmse", "mse", "deviation", "trimmed_rmse", "psnr", "psnr_error", "ssim",
           "ssim_error", "exposure"]
TRIMMED = 0.001    # share of pixels
WINDOW = 11        # pixels: the smallest picture that SSIM has a window for


def trimmed_mse(image, half_a, half_b, share=TRIMMED):
    """Mean of (image - half_a)(image - half_b) without the share of pixels, rounded up, that are farthest from the reference."""
    reference = (half_a + half_b) / 2
    distance = ((image - reference) ** 2).sum(axis=2)
    products = ((image - half_a) * (image - half_b)).mean(axis=2)
    finite = numpy.isfinite(distance) & numpy.isfinite(products)
    order = numpy.argsort(distance[finite], kind="stable")
    kept = order[:len(order) - int(numpy.ceil(share * len(order)))]
    return float(products[finite][kept].mean()) if len(kept) else float("nan")


def on_screen(picture, reference):
    """(PSNR in decibels, SSIM) of two pictures of display values in [0, 1]."""
    from skimage import metrics    # which takes half a second to load, and is wanted here alone
    if (picture == reference).all():
        return float("inf"), 1.0
    psnr = metrics.peak_signal_noise_ratio(reference, picture, data_range=1.0)
    if min(picture.shape[:2]) < WINDOW:
        return float(psnr), float("nan")
    ssim = metrics.structural_similarity(reference, picture, data_range=1.0, channel_axis=2, gaussian_weights=True, sigma=1.5,
                                         use_sample_covariance=False)
    return float(psnr), float(ssim)
