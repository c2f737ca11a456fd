"""What tests of the analysis share. Importing it finds the analysis."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
ANALYSIS = ROOT / "analysis"
sys.path.insert(0, str(ANALYSIS))
