"""One file a figure: a function that takes records and returns a figure, and a few lines that describe its command."""
