"""Rows into methods. A method is a set of settings (integrator, alpha, radius, ...) under the name that the experiment gives it, and
has a label. That is the name, and of what is swept under it the settings that tell its points apart; without a name, the integrator
and of its settings those that differ from another method's. Neither the seed makes a method nor the number of threads, which changes
no result and may be another after a night on another machine.
"""

import itertools
import math
import re

import pandas

from photonlab.records.columns import as_number

LABEL_BEGINS = ["integrator", "mode"]    # the first is always named, the second where it differs at all
GIVEN = "given_name"                     # column of rows: `name` of the method in the experiment file, "" where it has none
RECORDED = "method"                      # column of the records: the same, or the integrator


def point_of(run):
    """A run's name without its seed: the point of the experiment that it is a repetition of."""
    return run.rpartition("_seed-")[0] if "_seed-" in run else run


def given_names(rows, columns):
    """What the experiment calls the method of each row. Records without that column have it in the names of their runs, between the
    scene and what is swept: SCENE_NAME_alpha-0.5_seed-1."""
    if RECORDED in rows:
        names = rows[RECORDED]
    else:
        swept = "|".join([*map(re.escape, columns.settings), "radius"])
        swept = re.compile(rf"(_({swept})-[^_]*)+$")

        def name_in(scene, run):
            point = point_of(run)
            return swept.sub("", point.removeprefix(f"{scene}_")) if point.startswith(f"{scene}_") and point != run else ""
        names = pandas.Series(list(map(name_in, rows["scene"], rows["run"])), index=rows.index, dtype=str)
    return names.where(names != rows["integrator"], "")


def settings_of(rows, columns):
    """The columns of settings: those that are described and, of columns that are not, those that no row of a point changes, but some
    point does."""
    points = rows["run"].map(point_of)
    return columns.settings + [name for name in rows.columns if name not in columns and name not in [GIVEN, RECORDED] and
                               rows[name].nunique() > 1 and (rows[name].groupby(points).nunique() == 1).all()]


def table_settings(rows, columns):
    """{column: text} of what tables say of the method that these rows are of."""
    return {**rows.iloc[0][columns.settings], "threads": ";".join(dict.fromkeys(rows["threads"]))}


def kind_of(row, columns):
    """What kind of method it is, as ((setting, value), ...): of the choices that lead the table, the integrator and what only it has
    (a mode, a schedule), those that apply."""
    leading = itertools.takewhile(lambda name: not columns[name].label, columns.settings)
    return tuple((name, row[name]) for name in leading if row[name])


def method_labels(rows, columns):
    """A label for each row; rows of one scene have the same one only where they are of the same method."""
    settings = settings_of(rows, columns)
    runs = rows.drop_duplicates("run")[["run", "scene", *settings, GIVEN]]    # whose rows have the same ones
    found = runs.drop(columns="run").drop_duplicates()
    labels = pandas.Series("", index=found.index)
    for name, own in found.groupby(GIVEN):
        if name == "":
            labels[own.index] = labels_by_settings(own, settings, columns, set(LABEL_BEGINS[:1]))
        else:
            swept = labels_by_settings(own, settings, columns, set())
            labels[own.index] = [f"{name}, {text}" if text else name for text in swept]
    for _, own in found.groupby([found["scene"], labels]):
        if len(own) > 1:    # values that differ in later digits than are shown, or a name that is like another's label
            differing = [name for name in [*settings, GIVEN] if own[name].nunique() > 1]
            told = own[differing].apply(lambda row: ", ".join(f"{name} = {text}" for name, text in row.items() if text), axis=1)
            labels[own.index] = labels[own.index] + [f" ({text or 'unnamed'})" for text in told]
    labelled = runs.merge(found.assign(label=labels), on=["scene", *settings, GIVEN], how="left")
    return rows["run"].map(labelled.set_index("run")["label"]).to_numpy()


def labels_by_settings(found, settings, columns, named):
    """Of each method, the settings in `named` and those that take more than one value among the methods of some scene to which they
    apply. Where that leaves two methods of a scene with one label, what only one of them has is named as well."""
    def varying(groups, empty_counts):
        return {name for _, group in groups for name in settings
                if group[name][empty_counts | (group[name] != "")].nunique() > 1}

    def labels(named):
        def label(row):
            return ", ".join(columns.setting_text(name, row[name]) for name in settings if name in named and row[name] != "")
        return found.apply(label, axis=1)

    _, second = LABEL_BEGINS
    named = named | ({second} if second in found and found[second].nunique() > 1 else set())
    named |= varying(found.groupby("scene"), empty_counts=False)
    named -= {name for name in named if is_told_by_others(found, columns, name, named)}
    clashes = [group for _, group in found.groupby([found["scene"], labels(named)]) if len(group) > 1]
    named |= varying(enumerate(clashes), empty_counts=True)
    return labels(named)


def is_told_by_others(found, columns, name, named):
    """True where a setting follows from others that are named: each method that has it has one of those. So radii that follow from
    a sweep of footprints are not named beside it, nor "auto" and "given" beside a sweep of radii."""
    causes = [cause for cause in columns[name].follows if cause in named]
    has_it = found[found[name] != ""]
    return bool(causes) and (has_it[causes] != "").any(axis=1).all()


def methods_in_order(rows, columns):
    """Labels in the order for legends and strips: by the values of choices as the program lists them (so from PM to PPM, as theory
    goes), by other settings as numbers where they are numbers."""
    # A text that follows from others (auto, given) orders no better than they do.
    ordering = [name for name in [*settings_of(rows, columns), GIVEN] if not (columns[name].type == "text" and columns[name].follows)]
    first_rows = rows.drop_duplicates("method").set_index("method")
    return [label for label, _ in sorted(first_rows.iterrows(), key=lambda item: [columns[name].rank(item[1][name])
                                                                                 for name in ordering])]


def best_of_each_kind(scene, labels, rank):
    """Of each kind of method (PM by radius, PM by k, PPM, ...) the label of the least rank(label), the first of equals."""
    first_rows = scene.rows.drop_duplicates("method").set_index("method")
    best = {}
    for label in labels:
        kind = kind_of(first_rows.loc[label], scene.columns)
        best[kind] = min(best.get(kind, label), label, key=rank)
    return set(best.values())


def shown_methods(scene, alphas, all_methods, errors):
    """The method of each kind with the least of `errors`, {label: number}, and the first where that is not known; or all; or of those
    with an alpha the given ones."""
    if all_methods:
        return scene.labels
    first_rows = scene.rows.drop_duplicates("method").set_index("method")
    by_alpha = [label for label in scene.labels if alphas and first_rows.loc[label, "alpha"]]
    chosen = {label for label in by_alpha if as_number(first_rows.loc[label, "alpha"]) in alphas}
    chosen |= best_of_each_kind(scene, [label for label in scene.labels if label not in by_alpha],
                                lambda label: errors.get(label, math.inf))
    return [label for label in scene.labels if label in chosen]


def run_of(scene, label, seed):
    """A method's run with a given seed (None: the lowest), by its rows; None without such a run."""
    rows = scene.of_method(label)
    rows = rows[rows["seed"] == (rows["seed"].min() if seed is None else seed)]
    return None if rows.empty else rows
