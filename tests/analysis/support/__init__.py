"""What tests of the analysis share. Importing it finds the analysis."""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")    # no test opens a window

ROOT = Path(__file__).resolve().parents[3]
ANALYSIS = ROOT / "analysis"
sys.path.insert(0, str(ANALYSIS))
