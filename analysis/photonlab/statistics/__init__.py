"""What is computed from records: means over seeds, standard errors, bias and variance, slopes, times. Nothing here draws."""
