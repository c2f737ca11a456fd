"""What the page shows of the folder's other files: figures, tables that other commands wrote, the settings of runs."""

import base64
import json
from html import escape

from photonlab.drawing.saving import records_of_png
from photonlab.records import files, kept_files, tables
from photonlab.report.cells import cells, table

DERIVED_TABLES = {"metrics.csv": "Other metrics", "fits.csv": "Fits", "best-alphas.csv": "Best alphas",
                  "decomposition.csv": "Variance and squared bias"}


def shown_files(results):
    """The figures and tables of the folder."""
    return [*sorted((results.folder / "figures").glob("*.png")),
            *(results.folder / name for name in DERIVED_TABLES if files.is_there(results.folder / name))]


def figures(results, stale):
    """{name: html} of the figures of these records; the names of others go to `stale`."""
    drawn = {file: files.read_bytes(file) for file in sorted((results.folder / "figures").glob("*.png"))}
    stale += [f"figures/{file.name}" for file, data in drawn.items() if records_of_png(data) != results.hash]
    return {file.name: f'<figure><img alt="{escape(file.name)}" src="data:image/png;base64,{base64.b64encode(data).decode()}">'
            f"<figcaption>{escape(file.name)}</figcaption></figure>" for file, data in drawn.items()
            if records_of_png(data) == results.hash}


def made_from(results):
    """The hash of all that the page is made from: the records, figures and tables."""
    hashed = kept_files.running_hash(results.hash.encode())
    for file in shown_files(results):
        hashed.update(str(file.name).encode() + files.read_bytes(file))
    return hashed.hexdigest()


def derived_table(name, title, rows, results):
    """A CSV that another command wrote. The name of a method stands for its settings, and what is the same in all rows is said once,
    above."""
    notes = []
    if name == "decomposition.csv" and "pass" in rows.columns and not rows.empty:
        passes = tables.to_numbers(name, rows["pass"], whole=True)
        owner = [rows[column] for column in ["scene", "point"] if column in rows.columns]
        last = passes.groupby(owner).transform("max") if owner else passes.max()
        rows = rows[passes == last]
        notes.append("the last pass alone; the file has all of them")
    if "method" in rows.columns:    # which says all that they do
        rows = rows.drop(columns=["point", *results.columns.table_settings], errors="ignore")
    rows = rows[[column for column in rows.columns if (rows[column] != "").any()]]
    if len(rows.drop_duplicates()) > 1:
        same = [column for column in rows.columns if rows[column].nunique() == 1]
        if same:
            values = [cells(rows[column].iloc[:1])[0] for column in same]
            notes.append("in all rows " + ", ".join(f"{column} = {value[0] if isinstance(value, tuple) else value}"
                                                    for column, value in zip(same, values)))
        rows = rows.drop(columns=same)
    if rows.empty:
        return f"<p>{escape(name)} has no rows.</p>"
    return table(f"{title} ({name})", "; ".join(notes), [], list(rows.columns),
                 list(zip(*(cells(rows[column]) for column in rows.columns))))


def derived_tables(results, stale):
    """The tables that other commands made from these records; the names of others go to `stale`."""
    shown = ""
    for name, title in DERIVED_TABLES.items():
        if not files.is_there(results.folder / name):
            continue
        rows = tables.read_table(results.folder / name)
        if tables.is_stale(rows, results.hash):
            stale.append(name)
        else:
            shown += derived_table(name, title, rows.drop(columns=tables.RECORDS, errors="ignore"), results)
    return shown


def flattened(value, name=""):
    """[("settings.alpha", 0.7), ...] of the objects in run.json; lists stay whole."""
    if not isinstance(value, dict):
        return [(name, value)]
    return [line for key, inner in value.items() for line in flattened(inner, f"{name}.{key}" if name else key)]


def settings(runs):
    """Every run's run.json, folded; what is null does not apply to the run."""
    folded = []
    for name, run in runs.items():
        texts = [(place, value if isinstance(value, str) else json.dumps(value))
                 for place, value in flattened(run.description) if value is not None]
        lines = "".join(f"<dt>{escape(place)}</dt><dd>{escape(text)}</dd>" for place, text in texts)
        folded.append(f"<details><summary>{escape(name)}</summary><dl>{lines}</dl></details>")
    return "".join(folded)
