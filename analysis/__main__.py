"""Draws what `photonlab run` recorded.

    /usr/bin/python3 analysis RESULTS                          all that the folder has
    /usr/bin/python3 analysis COMMAND RESULTS [options]        one figure or table
    /usr/bin/python3 analysis --help                           which there are

README.md says how to read them. Where the package is installed, `python3 -m photonlab` is the same.
"""

from photonlab import __main__    # which stands beside this file, where Python looks first
