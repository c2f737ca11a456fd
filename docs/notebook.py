"""What can be asked of a folder of results in a notebook; as a script: /usr/bin/python3 docs/notebook.py results/demo

In Jupyter the parts stand in cells of their own, and the figures below them. Importing photonlab changes neither the backend of
matplotlib nor its settings, and none of this writes into the folder.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "analysis"))    # not where the package is installed

import photonlab

results = photonlab.load(sys.argv[1])

# A tidy table: a row a run, recorded pass and component. Numbers are numbers, and columns have units.
frame = results.frame
print(frame.groupby("method", observed=True)["mse_unbiased"].min())
print("seconds are in", frame.attrs["units"]["seconds"])

# Which method is best at which budget, by how much, and how many more seeds would tell what cannot be told.
answers = photonlab.answers(results)
print(answers[["scene", "budget", "unit", "best", "lead", "verdict"]].to_string())

# Figures: one of a scene, with what it is to show; or all of a kind by name.
scene = results.scene_named(frame["scene"].iloc[0])
figure = photonlab.figures.convergence.draw(scene, components=["gathered"], against=["seconds"], width=84)
print(figure.axes[0].get_title(loc="left"))
for name, figure in photonlab.figures.of("memory", results).items():
    print(name, "of", len(figure.axes), "panels")
