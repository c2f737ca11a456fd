"""Reads what `photonlab run` recorded, tells which method is best, and draws it.

    import photonlab
    results = photonlab.load("results/demo")
    results.frame                                                             # a tidy table; results.frame.attrs["units"]
    photonlab.answers(results)                                                # which method is best, as a table
    photonlab.figures.convergence.draw(results.scene_named("cornell-box"))    # a figure of matplotlib
    photonlab.figures.of("strip", results, width=84)                          # {name: figure} of any kind

Nothing else is changed: neither the backend of matplotlib nor its settings, nor the folder of results. The same from a shell:
`python3 -m photonlab --help`.
"""

from photonlab import figures
from photonlab.answering import frame_of as answers
from photonlab.records.records import read as load

__all__ = ["answers", "figures", "load"]
