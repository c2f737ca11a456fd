"""Which method is best at a budget, by how much, and whether that can be told.

A budget is a number of passes or of seconds. Each seed of each method has an error there: its unbiased MSE of the recorded pass, or
after so many seconds that of the place where the seed's own clock puts it between two recorded passes. There the method's mean curve
is followed, by straight lines on logarithmic axes, and the seed keeps its share of it: its deviation from the mean, in parts of the
mean, is interpolated with the logarithm of the pass. So the scatter of the seeds holds that of their times, and errors may be negative.
Nothing is extrapolated.

The best method is the one with the least mean. Its lead is the difference of means, with a standard error over seeds: paired where
both methods have the same seeds, since their photons are then the same or alike; as of Welch 1947 where they have not. A lead is told
where Student's test of no difference, two-sided at 5%, refuses it against each of the others. That the two were chosen for being the
best and the next of many makes the test no less strict than its level (Gutmann and Maymin 1987, "Is the Selected Population the
Best?"). The reference's own noise is in no standard error: what it adds is nearly the same for all methods.

Where the lead cannot be told, the number of seeds that would tell it is the least n at which the same test, of differences with the
mean and the standard deviation that were seen, comes out significant with a probability of 80%: by the noncentral t distribution with
n - 1 degrees of freedom and noncentrality sqrt(n) mean / deviation. It is as uncertain as what was seen, and often off by a factor of
two. Seeds of unpaired methods are counted for each of them.
"""

import math
from dataclasses import dataclass, field

import numpy
from scipy import stats

from photonlab.statistics.errors import error_column, root

NAME = "answers.csv"
COLUMNS = ["scene", "component", "budget", "unit", "best", "rmse", "rmse_error", "seeds", "runner_up", "runner_up_rmse", "lead",
           "lead_error", "p", "paired", "verdict", "more_seeds", "tied", "left_out"]
LEVEL = 0.05           # of the test
POWER = 0.8            # with which more seeds are to tell
MOST_SEEDS = 100_000   # beyond, two methods are as good as equal
UNITS = ["passes", "seconds"]
TOLD, CANNOT_TELL, ONE_SEED, ALONE, SAME = "told", "cannot tell", "one seed", "alone", "the same"


@dataclass
class Standing:
    """The errors of a method at a budget."""
    label: str
    by_seed: dict    # {seed: MSE}

    @property
    def mean(self):
        return float(numpy.mean(list(self.by_seed.values())))

    @property
    def error(self):
        """Standard error of the mean; NaN with one seed."""
        values = list(self.by_seed.values())
        return float(numpy.std(values, ddof=1) / math.sqrt(len(values))) if len(values) > 1 else math.nan


@dataclass
class Answer:
    """What is told of a scene at a budget."""
    scene: str
    component: str
    budget: float
    unit: str                                     # "passes" or "seconds"
    best: Standing = None
    others: list = field(default_factory=list)    # [Standing], by their means
    leads: list = field(default_factory=list)     # [Lead] over the others
    left_out: dict = field(default_factory=dict)  # {label: why it has no error here}

    @property
    def runner_up(self):
        return self.others[0] if self.others else None

    @property
    def tied(self):
        """Labels of those over which the lead cannot be told."""
        return [other.label for other, lead in zip(self.others, self.leads) if not lead.is_told]

    @property
    def verdict(self):
        if not self.others:
            return ALONE
        if self.leads[0].is_same:
            return SAME
        if not self.tied:
            return TOLD
        return ONE_SEED if any(math.isnan(lead.error) for lead in self.leads) else CANNOT_TELL

    @property
    def more_seeds(self):
        """That would tell the lead over all that are tied; None where it is told or nothing is known of it."""
        needed = [lead.more_seeds for lead in self.leads if not lead.is_told and not lead.is_same]
        return None if not needed or None in needed else max(needed)


@dataclass
class Lead:
    """By how much a method is better than another, in MSE."""
    mean: float
    error: float     # standard error; NaN where a method has one seed
    p: float         # of no difference, two-sided
    pairs: int       # seeds that both have; 0 where they are not paired
    seeds: int       # that the standard error is over

    @property
    def more_seeds(self):
        """That would tell it; None where it is told, or nothing is known of its spread."""
        if self.is_told or not self.error > 0:
            return None
        return max(1, seeds_needed(abs(self.mean) / (self.error * math.sqrt(self.seeds))) - self.seeds)

    @property
    def is_told(self):
        return self.p < LEVEL

    @property
    def is_same(self):
        return self.mean == 0 and self.error == 0


def lead_of(best, other):
    """The lead of a standing over another."""
    common = sorted(set(best.by_seed) & set(other.by_seed))
    if len(common) == len(best.by_seed) == len(other.by_seed):
        differences = numpy.array([other.by_seed[seed] - best.by_seed[seed] for seed in common])
        return lead_from(differences.mean(), deviation(differences) / math.sqrt(len(common)), len(common) - 1, len(common), len(common))
    groups = [numpy.array(list(standing.by_seed.values())) for standing in [other, best]]
    mean, counts = groups[0].mean() - groups[1].mean(), [len(group) for group in groups]
    shares = [deviation(group) ** 2 / len(group) for group in groups]
    error = math.sqrt(sum(shares))
    freedom = error ** 4 / sum(share ** 2 / (count - 1) for share, count in zip(shares, counts)) if error > 0 else min(counts) - 1
    return lead_from(mean, error, freedom, 0, min(counts))


def deviation(values):
    return float(numpy.std(values, ddof=1)) if len(values) > 1 else math.nan


def lead_from(mean, error, freedom, pairs, seeds):
    """A lead with its test."""
    if math.isnan(error):
        p = math.nan
    elif error == 0:
        p = 1.0 if mean == 0 else 0.0
    else:
        p = float(2 * stats.t.sf(abs(mean) / error, freedom))
    return Lead(float(mean), float(error), p, pairs, seeds)


def power_of(effect, seeds):
    """The probability that the paired test of so many seeds is significant, where the mean is `effect` standard deviations."""
    # The noncentral t distribution as a mean over that of the deviation: scipy's own is no number for some few degrees of freedom.
    deviations = numpy.sqrt(stats.chi2.ppf((numpy.arange(1000) + 0.5) / 1000, seeds - 1) / (seeds - 1))
    bounds, centre = stats.t.ppf(1 - LEVEL / 2, seeds - 1) * deviations, math.sqrt(seeds) * effect
    return float((stats.norm.sf(bounds - centre) + stats.norm.cdf(-bounds - centre)).mean())


def seeds_needed(effect):
    """The least number of seeds whose test has the power; MOST_SEEDS where it is more."""
    # Of many seeds the deviation is as good as known.
    normal = (stats.norm.ppf(1 - LEVEL / 2) + stats.norm.ppf(POWER)) ** 2 / effect ** 2 if effect > 0 else math.inf
    if normal > 1000:
        return int(min(normal, MOST_SEEDS)) + 1
    seeds = max(2, int(normal))
    while power_of(effect, seeds) < POWER:
        seeds += 1
    return seeds


def seed_curves(rows):
    """(passes, seeds, MSE by pass and seed, seconds likewise) of one method and component, at the passes that all its seeds recorded,
    without pass 0 and where time is known."""
    rows = rows[rows["pass"] > 0]
    column = error_column(rows)
    errors = rows.pivot(index="pass", columns="seed", values=column).dropna()
    seconds = rows.pivot(index="pass", columns="seed", values="seconds").reindex(errors.index)
    return errors.index.to_numpy(), [int(seed) for seed in errors.columns], errors.to_numpy(), seconds.to_numpy()


def at_passes(curves, budget):
    """{seed: MSE} after so many passes, or why there is none."""
    passes, seeds, errors, _ = curves
    place = numpy.flatnonzero(passes == budget)
    if not len(place):
        return "more than recorded" if not len(passes) or budget > passes[-1] else "not recorded"
    return dict(zip(seeds, errors[place[0]].tolist()))


def at_seconds(curves, budget):
    """{seed: MSE} after so many seconds, or why there is none."""
    passes, seeds, errors, seconds = curves
    if not len(passes) or not (seconds > 0).all():
        return "no times"
    if budget < seconds[0].max():
        return "less than one pass"
    if budget > seconds[-1].min():
        return "more than recorded"
    means = errors.mean(axis=1)
    found = {}
    for place, seed in enumerate(seeds):
        right = max(1, int(numpy.searchsorted(seconds[:, place], budget)))
        if right == len(passes) or len(passes) == 1:    # it is the last
            found[seed] = float(errors[-1, place])
            continue
        pair = slice(right - 1, right + 1)
        if (means[pair] <= 0).any():
            return "not resolved"
        share = numpy.interp(math.log(budget), numpy.log(seconds[pair, place]), [0.0, 1.0])
        kept = errors[pair, place] / means[pair]
        found[seed] = float(math.exp((1 - share) * math.log(means[pair][0]) + share * math.log(means[pair][1])) *
                            ((1 - share) * kept[0] + share * kept[1]))
    return found


AT = {"passes": at_passes, "seconds": at_seconds}


def answer(scene, component, curves, budget, unit, groups=None):
    """The answer at one budget. `curves` are seed_curves() by label. With `groups`, {label: group}, only the best of each group
    competes."""
    found, left_out = [], {}
    for label, of_method in curves.items():
        errors = AT[unit](of_method, budget)
        if isinstance(errors, str):
            left_out[label] = errors
        elif errors:
            found.append(Standing(label, errors))
    found.sort(key=lambda standing: standing.mean)
    if groups:
        found = [standing for place, standing in enumerate(found)
                 if groups[standing.label] not in [groups[other.label] for other in found[:place]]]
    best, *others = found or [None]
    return Answer(scene, component, budget, unit, best, others, [lead_of(best, other) for other in others], left_out)


def budgets_of(curves, unit):
    """Powers of four below the largest budget that most can be compared at, and that one: the last recorded pass that all methods
    have in common, or the time that all reach."""
    known = [of_method for of_method in curves.values() if len(of_method[0])]
    if not known:
        return []
    if unit == "passes":
        common = sorted(set.intersection(*(set(of_method[0]) for of_method in known)))
        return [budget for place, budget in enumerate(reversed(common)) if place % 2 == 0][::-1]
    first = max(of_method[3][0].max() for of_method in known)
    last = min(of_method[3][-1].min() for of_method in known)
    if not 0 < first <= last:
        return []
    powers = [2.0 ** power for power in range(math.ceil(math.log2(first)), math.floor(math.log2(last)) + 1)]
    return powers[::-2][::-1] or [last]


def answers_of(scene, component="total", budgets=None, between=None):
    """The answers of the records of one scene: at `budgets`, {unit: numbers}, or where those are not given at budgets_of(). With
    `between`, the name of a setting, the best methods of its values compete."""
    rows = scene.rows[(scene.rows["component"] == component) & scene.rows["mse"].notna()]
    curves = {label: seed_curves(rows[rows["method"] == label]) for label in scene.labels if (rows["method"] == label).any()}
    groups = dict(zip(rows["method"], rows[between])) if between else None
    return [answer(scene.scene, component, curves, budget, unit, groups)
            for unit in UNITS for budget in (budgets_of(curves, unit) if budgets is None else budgets.get(unit, []))]


def row_of(found):
    """An answer as a row of the table. Leads are in RMSE, as parts of the best one's."""
    row = {"scene": found.scene, "component": found.component, "budget": found.budget, "unit": found.unit,
           "left_out": "; ".join(f"{label}: {why}" for label, why in found.left_out.items())}
    if found.best is None:
        return {**row, "verdict": "no method"}
    rmse, error = root_with_error(found.best.mean, found.best.error)
    row.update(best=found.best.label, rmse=rmse, rmse_error=error, seeds=len(found.best.by_seed), verdict=found.verdict,
               tied="; ".join(found.tied))
    if found.others:
        relative, relative_error = relative_lead(found)
        row.update(runner_up=found.runner_up.label, runner_up_rmse=root(found.runner_up.mean), lead=relative, lead_error=relative_error,
                   p=found.leads[0].p, paired="yes" if found.leads[0].pairs else "no", more_seeds=found.more_seeds)
    return row


def root_with_error(mean, error):
    """RMSE and its standard error, of those of an MSE."""
    value = root(mean)
    return value, error / (2 * value) if value > 0 else math.nan


def relative_lead(found, place=0):
    """(by which part of the best one's RMSE that of one of the others is larger, its standard error); NaN where an error is not
    resolved. The first of the others is the runner-up."""
    best, other, lead = found.best, found.others[place], found.leads[place]
    if not best.mean > 0:
        return math.nan, math.nan
    ratio = math.sqrt(other.mean / best.mean)
    if lead.pairs:    # of the logarithm of the ratio, seed by seed
        parts = numpy.array([other.by_seed[seed] / other.mean - errors / best.mean for seed, errors in best.by_seed.items()])
        error = deviation(parts) / math.sqrt(len(parts))
    else:
        error = math.hypot(best.error / best.mean, other.error / other.mean)
    return ratio - 1, ratio / 2 * error
