"""What a reader wants first: which method is best, with the pictures and the curves that show it, and what to beware of."""

from html import escape

from photonlab.answering import caption_of, error_text, lead_text, lines_of, verdict_text
from photonlab.records import files
from photonlab.report.cells import table
from photonlab.statistics import answers, errors
from photonlab.statistics.errors import two_digits

COLUMNS = ["budget", "best method", "RMSE", "its lead over the runner-up"]
# Of each scene's figures the first that is there of each line is shown with the conclusion.
SHOWN = [["equal-time", "strip"], ["convergence"]]
UNSTEADY = 0.2    # standard deviation of seconds over seeds, as a share of their mean, that is worth a warning


def sentence(found):
    """What the answer at the largest budget is, for those who read one line."""
    place = f"after {found.budget:,.0f} passes" if found.unit == "passes" else f"after {found.budget:g} s"
    if found.verdict == answers.TOLD:
        return f"{found.best.label} is best {place}: RMSE {error_text(found)}; that of {found.runner_up.label} is " \
            f"{lead_text(found)} larger."
    return f"{found.best.label} has the least RMSE {place}, {error_text(found)}; {verdict_text(found)}."


def of_scene(scene):
    """The conclusion of the records of one scene; "" where there are no errors."""
    listed = [found for found in answers.answers_of(scene) if found.best]
    if not listed:
        return ""
    last = [found for found in listed if found.others and found.unit == listed[-1].unit][-1:]
    said = "".join(f'<p class="said">{escape(scene.scene)}: {escape(sentence(found))}</p>' for found in last)
    note = "± one standard error over seeds; a lead is by how much the runner-up's RMSE is larger"
    return said + table(f"Which method is best: {caption_of(scene, scene.scene, 'total')}", note, [], COLUMNS,
                        [lines_of(found) for found in listed])


def conclusion(results, drawn):
    """All scenes, each with its figures, which are taken out of `drawn`, {name: html}."""
    parts = []
    for scene in results.scenes():
        parts.append(of_scene(scene))
        for names in SHOWN:
            files_of_scene = [f"{name}-{files.as_file_name(scene.scene)}.png" for name in names]
            parts += [drawn.pop(name) for name in [name for name in files_of_scene if name in drawn][:1]]
    return "".join(parts)


def warnings(results, runs):
    """What makes the numbers worth less than they look, as sentences."""
    rows, said = results.rows, []
    for scene in results.scenes():
        said += of_reference(scene, runs) + of_pixels(scene) + of_times(scene)
    said += of_runs(runs)
    seeds = rows.groupby(["scene", "method"])["seed"].nunique()
    if seeds.min() != seeds.max():
        said.append(f"Methods have from {seeds.min()} to {seeds.max()} seeds.")
    elif seeds.max() == 1 and rows["method"].nunique() > 1:
        said.append("With one seed nothing is known of the spread, so no lead can be told.")
    return said


def of_reference(scene, runs):
    said = []
    for run in scene.rows["run"].unique():
        judge = runs[run].description.get("reference") if run in runs else None
        check = judge.get("check") if isinstance(judge, dict) else None
        if isinstance(check, dict) and check.get("verdict") == "disputed":
            said.append(f"{scene.scene}: its reference {judge['path']} is disputed: {check.get('why', '')}")
    for label in scene.labels:
        own = scene.of_method(label)
        last = errors.last_pass(own[(own["component"] == "total") & own["mse"].notna()])
        floor, error = last["reference_floor"].max(), last[errors.error_column(last)].mean() if len(last) else 0.0
        if floor > error > 0:
            said.append(f"{scene.scene}: the reference's own noise, RMSE {two_digits(errors.root(floor))}, is more than the error of "
                        f"{label}, {two_digits(errors.root(error))}: more samples in the reference would tell that error better.")
    return list(dict.fromkeys(said))


def of_pixels(scene):
    rows = scene.rows[(scene.rows["component"] == "total") & (scene.rows["nonfinite"] > 0)]
    return [f"{scene.scene}: {label} has up to {own['nonfinite'].max():.0f} pixels that are not finite; its errors are without them."
            for label, own in rows.groupby("method", sort=False)]


def of_times(scene):
    said = []
    for label in scene.labels:
        own = scene.of_method(label)
        seconds = errors.last_pass(own[own["component"] == "total"])["seconds"]
        if len(seconds) > 1 and seconds.std() > UNSTEADY * seconds.mean():
            said.append(f"{scene.scene}: the seconds of {label} differ from seed to seed by {seconds.std() / seconds.mean():.0%}: "
                        "something else may have been running.")
    return said


def of_runs(runs):
    """Of runs that are not of one program and one machine, and of light that was cut."""
    said = []
    for what, keys, why in [("versions of the program", ("program", "commit"), "what changed between them is in the numbers"),
                            ("processors", ("processor",), "their seconds cannot be compared")]:
        values = set()
        for run in runs.values():
            value = run.description
            for key in keys:
                value = value.get(key) if isinstance(value, dict) else None
            values.add(str(value or ""))
        if len(values - {""}) > 1:
            said.append(f"The runs are of {len(values - {''})} {what}: {why}.")
    counters = [run.description.get("counters") for run in runs.values()]
    cut = sum(found["paths_cut"] for found in counters if isinstance(found, dict) and isinstance(found.get("paths_cut"), int))
    if cut:
        said.append(f"{cut:,} light paths were cut after 10,000 edges; run.json says how much power that was.")
    return said
