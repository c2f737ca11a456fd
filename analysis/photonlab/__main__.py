"""The command line, as `python3 -m photonlab` and as `python3 analysis`."""

import sys

try:
    from photonlab import command_line
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, scipy, pandas, matplotlib, xxhash and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-scipy, python3-pandas, python3-matplotlib, python3-xxhash and python3-openimageio)",
          file=sys.stderr)
    sys.exit(2)

command_line.run()
