"""Says which method is best, for every scene and at every budget of passes and of seconds: its error with the standard error over
seeds, and its lead over the runner-up; or that this cannot be told, and how many more seeds would tell it.

Budgets are powers of four of the passes that all methods recorded, and of the seconds that all have, up to the largest; or those of
--passes and --seconds. Errors between recorded passes are interpolated, and never beyond. An error is the root of the mean over seeds
of the squared error, free of the reference's noise where the reference has two halves; its "±" is one standard error of that mean. A
lead is by how much the runner-up's RMSE is larger. It is told where a test of the best against the runner-up, and against every other
method, is significant at 5%, over pairs of seeds where the methods share them. "N more seeds would": so many more would make the test
significant with a probability of 80%, if the difference and its spread are as they were seen.

--between integrator lets the best method of each integrator compete, so that PM at its best meets PPM at its best.
"""

import argparse
import math
import shutil

import pandas

from photonlab import typesetting
from photonlab.command import Command, has, positive
from photonlab.records import records, tables
from photonlab.records.files import InputError
from photonlab.statistics import answers, errors
from photonlab.statistics.errors import two_digits

COLUMNS = ["budget", "best", "RMSE", "lead over the runner-up"]
LIGHT = {"total": "whole image", "emission": "emission alone", "direct": "direct light alone", "gathered": "gathered light alone"}


def budget_text(found):
    return f"{found.budget:,.0f} pass{'' if found.budget == 1 else 'es'}" if found.unit == "passes" else f"{found.budget:g} s"


def with_error(value, error):
    """ "0.00322 ± 0.00001": as many digits as the error has, which has one or two."""
    if math.isnan(value):
        return "below resolution"
    if not error > 0:
        return f"{value:.3g}"
    digits = max(0, -math.floor(math.log10(error)) + (f"{error:e}"[0] == "1"))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def error_text(found):
    return with_error(*answers.root_with_error(found.best.mean, found.best.error))


def lead_text(found, place=0):
    """Of the lead over one of the others; the first is the runner-up."""
    relative, error = answers.relative_lead(found, place)
    return "a lead that is not resolved" if math.isnan(relative) else f"{with_error(100 * relative, 100 * error)}%"


def seeds_text(count):
    if count is None:
        return "more seeds would"
    return f"more than {answers.MOST_SEEDS:,} more seeds would" if count >= answers.MOST_SEEDS else \
        f"{count:,} more seed{'' if count == 1 else 's'} would"


def verdict_text(found):
    """What is told of the lead, as the end of a sentence."""
    verdict = found.verdict
    if verdict == answers.ALONE:
        return "no other method has an error here"
    runner_up = found.runner_up.label
    if verdict == answers.SAME:
        return f"the same as {runner_up}"
    if verdict == answers.TOLD:
        return f"{lead_text(found)} over {runner_up}"
    places = [place for place, lead in enumerate(found.leads) if not lead.is_told]
    first = f"cannot tell from {found.others[places[0]].label} (lead {lead_text(found, places[0])})"
    of_them = first if len(places) == 1 else f"{first} and {len(places) - 1} other{'' if len(places) == 2 else 's'}"
    if verdict == answers.ONE_SEED:
        return f"{of_them}: with one seed nothing is known of the spread; 3 more seeds would show it"
    return f"{of_them}; {seeds_text(found.more_seeds)}"


def lines_of(found):
    """The cells of an answer in the table."""
    if found.best is None:
        return [budget_text(found), "–", "–", "no method has an error here"]
    return [budget_text(found), found.best.label, error_text(found), verdict_text(found)]


def left_out_text(listed):
    """What has no error at some budgets, as sentences."""
    reasons = {}
    for found in listed:
        for label, why in found.left_out.items():
            reasons.setdefault((label, why), []).append(budget_text(found))
    return [f"{label} is left out at {', '.join(budgets)}: {why}." for (label, why), budgets in reasons.items()]


def wanting(results):
    """What the folder does not have that would tell more, as sentences."""
    rows, texts = results.rows, []
    for scene, own in rows.groupby("scene", sort=False):
        if own["mse"].isna().all():
            texts.append(f"{scene} has no errors: make a reference (`photonlab reference`) and name it in the experiment file.")
            continue
        if own["seed"].nunique() == 1:
            texts.append(f"{scene} has one seed: `seeds = 4` in the experiment file would show the spread, and which leads are real.")
        if results.labels and own["method"].nunique() == 1:
            texts.append(f"{scene} has one method: a second [[method]] would have something to compare with.")
    if not has("ensembles")(results):
        texts.append("Bias and variance are not told apart: `decomposition = true` in the experiment file would.")
    return texts


def caption_of(results, scene, component):
    of_component = results.rows[(results.rows["scene"] == scene) & (results.rows["component"] == component)]
    return f"{scene}, {LIGHT[component]}. {errors.noise_note(of_component)}".rstrip()


def as_text(listed, kind, width):
    """The table of one scene. Where it is wider than the terminal, what is told of the lead stands in a line of its own."""
    cells = [lines_of(found) for found in listed]
    whole = typesetting.table(kind, COLUMNS, cells)
    if kind != "text" or max(map(typesetting.width_of, whole.split("\n"))) <= width:
        return whole
    narrow = typesetting.table(kind, COLUMNS[:-1], [row[:-1] for row in cells]).split("\n")
    return "\n".join([*narrow[:2], *(f"{line}\n    {row[-1]}" for line, row in zip(narrow[2:], cells))])


def budgets_in(options):
    """{unit: numbers} that were asked for; None where none was."""
    return None if options.passes is None and options.seconds is None else {"passes": options.passes or [],
                                                                           "seconds": options.seconds or []}


def listed_of(results, options):
    """[(records of a scene, component, its answers)] of what has errors."""
    if options.between is not None and options.between not in results.columns.settings:
        raise InputError(f"--between {options.between}: expected a setting, one of {', '.join(results.columns.settings)}")
    found = []
    for scene in results.scenes():
        for component in options.components:
            listed = answers.answers_of(scene, component, budgets_in(options), options.between)
            if any(one.best for one in listed):
                found.append((scene, component, listed))
    return found


def frame_of(results, components=("total",), passes=None, seconds=None, between=None):
    """The answers as a table, a row a scene, component and budget: the columns of answers.csv. Budgets are numbers of passes and of
    seconds; `between` is a setting, the best methods of whose values compete."""
    options = argparse.Namespace(components=list(components), passes=passes, seconds=seconds, between=between)
    rows = [answers.row_of(one) for _, _, listed in listed_of(results, options) for one in listed]
    return pandas.DataFrame(rows, columns=answers.COLUMNS)


def make(results, options):
    found = listed_of(results, options)
    width = shutil.get_terminal_size((110, 24)).columns
    for scene, component, listed in found:
        yield f"{caption_of(results, scene.scene, component)}\n\n{as_text(listed, options.table, width)}\n"
        yield from left_out_text(listed)
    yield from wanting(results)
    if not options.is_asked:
        yield tables.Derived(answers.NAME, answers.COLUMNS,
                                   [answers.row_of(one) for _, _, listed in found for one in listed])


def add_options(parser):
    parser.add_argument("--passes", type=positive, nargs="+", metavar="N", help="budgets in passes")
    parser.add_argument("--seconds", type=positive, nargs="+", metavar="S", help="budgets in seconds")
    parser.add_argument("--components", choices=records.COMPONENTS, nargs="+", default=["total"], help="which light (default: total)")
    parser.add_argument("--between", metavar="SETTING", help="the best methods of each value of this setting compete")
    parser.add_argument("--table", choices=typesetting.KINDS, default="text", help="how the table is set (default: text)")


COMMAND = Command(
    name="answer", summary="the best method at each budget, with its lead, into answers.csv", about=__doc__,
    writes="answers.csv, unless it is asked for something else than all",
    make=make, add_options=add_options)
