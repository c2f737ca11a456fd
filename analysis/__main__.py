"""Draws what `photonlab run` recorded.

    /usr/bin/python3 analysis RESULTS                          all that the folder has
    /usr/bin/python3 analysis COMMAND RESULTS [options]        one figure or table
    /usr/bin/python3 analysis --help                           which there are

README.md says how to read them.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[1])    # where the package is, from whatever folder it is called

try:
    from analysis import command_line
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, scipy, pandas, matplotlib, xxhash and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-scipy, python3-pandas, python3-matplotlib, python3-xxhash and python3-openimageio)",
          file=sys.stderr)
    sys.exit(2)

if __name__ == "__main__":
    command_line.run()
