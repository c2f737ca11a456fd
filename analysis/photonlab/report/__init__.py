"""The page of a results folder, RESULTS/report.html."""
