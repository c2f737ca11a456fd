"""Makes one page of a results folder: RESULTS/report.html. First which method is best, with the pictures and the curves that show it,
then the images themselves in a viewer that flips, wipes and subtracts them, tables of errors and costs, the other figures, and every
run's settings.

The page is a single file without anything to load, so that it can be mailed, archived or attached to a paper. Errors
are those of each method's last pass: RMSE is the root of the mean over seeds of `mse_unbiased`. What the folder does
not have (figures, snapshots, a reference) is said at the top of the page.
"""

import json
from html import escape
from pathlib import Path
from string import Template

import numpy

from photonlab.command import Command, whole_positive
from photonlab.drawing import style
from photonlab.records import files
from photonlab.report.conclusion import conclusion, warnings
from photonlab.report.folder import derived_tables, figures, made_from, settings
from photonlab.report.results import cost_table, distinct, error_table, extent, facts, found, read_runs, scene_table
from photonlab.report.viewer import seeds_left_out, viewer_scenes
from photonlab.statistics import errors

HERE = Path(__file__).parent


def part(name):
    """A file of the page that stands beside this one."""
    return (HERE / name).read_text(encoding="utf-8")


def inlined(data):
    """JSON that no text in it can end early: `</script>` in a name is only an escape."""
    return json.dumps(data, ensure_ascii=False).replace("<", "\\u003c")


def section(anchor, heading, content):
    return f'<section id="{anchor}"><h2>{heading}</h2>{content}</section>' if content else ""


def data_of(scenes):
    """What the viewer is given."""
    colours = style.pyplot.get_cmap(style.DIFFERENCE_COLOURS)(numpy.linspace(0, 1, 255), bytes=True)[:, :3].tolist()
    return inlined({"differenceColours": colours, "scenes": scenes})


def listed(anchor, heading, texts):
    items = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f'<div id="{anchor}" class="beware" role="note"><p>{heading}:</p><ul>{items}</ul></div>' if texts else ""


def page(results, seeds):
    """The whole page as text, with images of up to `seeds` seeds a method."""
    rows, missing, stale = results.rows, [], []
    runs = read_runs(results, missing)
    scenes = viewer_scenes(results, runs, missing, seeds)
    viewer = Template(part("viewer.html")).substitute(left_out=seeds_left_out(rows, runs, seeds),
                                                      noise=errors.noise_note(rows)) if scenes else ""
    drawn = figures(results, stale)
    first = conclusion(results, drawn)
    sections = {"answer": section("answer", "Which method is best", first), "viewer": viewer,
                "derived": section("derived", "Derived tables", derived_tables(results, stale)),
                "figures": section("figures", "Other figures" if first else "Figures", "\n".join(drawn.values())),
                "settings": section("settings", "How it was made", facts(rows, runs) + settings(runs))}
    missing += [f"{name}: was not made from the records that are here now, so it is not shown." for name in sorted(stale)]
    anchors = [("answer", "Which method is best", first), ("images", "Images", viewer), ("errors", "Errors and costs", True),
               ("figures", "Other figures", sections["figures"]), ("derived", "Derived tables", sections["derived"]),
               ("settings", "How it was made", True)]
    experiments = ", ".join(distinct(rows["experiment"]))
    title = " / ".join(distinct(found(run, "title") for run in runs.values())) or experiments
    return Template(part("page.html")).substitute(
        sections, experiments=escape(experiments), title=escape(title), style=part("page.css"), extent=extent(rows),
        warnings=listed("warnings", "To beware of", warnings(results, runs)), missing=listed("missing", "Missing from this folder", missing),
        contents=" · ".join(f'<a href="#{anchor}">{name}</a>' for anchor, name, there in anchors if there),
        scenes=scene_table(rows, runs), results="".join(error_table(scene) + cost_table(scene, runs) for scene in results.scenes()),
        data=data_of(scenes), script=part("page.js") + part("viewer.js"))


def make(results, options):
    yield files.replace_file(results.folder / "report.html", page(results, options.seeds))


def add_options(parser):
    parser.add_argument("--seeds", type=whole_positive, default=2, metavar="N", help="how many seeds of each method the viewer "
                        "has images of, of those with snapshots (default: 2); the page grows with it")


COMMAND = Command(
    name="report", summary="all of it as one HTML page that needs nothing else", about=__doc__,
    writes="report.html",
    make=make, made_from=made_from, add_options=add_options)
