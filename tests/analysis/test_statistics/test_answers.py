"""Which method is best is told where it can be, and no oftener than it may; the number of seeds that would tell is the number that does."""

import math
import unittest

import numpy

from photonlab import answering
from photonlab.statistics import answers
from photonlab.statistics.answers import Standing
from support import synthetic
from support.in_folder import InFolder


def standings(random, means, seeds, deviation=1.0, common=0.0):
    """Methods with normal errors; `common` is the deviation of what they share seed by seed."""
    shared = common * random.standard_normal(seeds)
    return [Standing(str(place), dict(enumerate(10 + mean + shared + deviation * random.standard_normal(seeds))))
            for place, mean in enumerate(means)]


def verdict_of(found):
    best, *others = sorted(found, key=lambda standing: standing.mean)
    return answers.Answer("box", "total", 1, "passes", best, others, [answers.lead_of(best, other) for other in others])


class Leads(unittest.TestCase):
    def test_methods_that_are_equal_are_told_apart_in_one_experiment_of_twenty_at_most(self):
        for methods in [2, 5]:
            random = numpy.random.default_rng(methods)
            told = sum(verdict_of(standings(random, [0.0] * methods, 6)).verdict == answers.TOLD for _ in range(2000))
            # Two of 2000 trials at 5%: 100 with a deviation of 9.7; more than 4 deviations above have a chance of 3e-5.
            self.assertLess(told, 139, methods)
            self.assertGreater(told, 61 if methods == 2 else 0, methods)

    def test_a_real_lead_is_told(self):
        random = numpy.random.default_rng(3)
        told = sum(verdict_of(standings(random, [0.0, 3.0, 4.0], 8)).verdict == answers.TOLD for _ in range(200))
        self.assertGreater(told, 190)

    def test_what_methods_share_seed_by_seed_drops_out_where_they_have_the_same_seeds(self):
        random = numpy.random.default_rng(4)
        best, other = standings(random, [0.0, 1.0], 8, deviation=0.1, common=5.0)
        paired = answers.lead_of(best, other)
        self.assertEqual(paired.pairs, 8)
        self.assertTrue(paired.is_told)
        apart = answers.lead_of(best, Standing("b", {seed + 100: value for seed, value in other.by_seed.items()}))
        self.assertEqual(apart.pairs, 0)
        self.assertFalse(apart.is_told)
        self.assertAlmostEqual(paired.mean, apart.mean)

    def test_unpaired_methods_are_compared_as_welch_has_it(self):
        from scipy import stats
        random = numpy.random.default_rng(5)
        one, two = random.normal(0, 1, 5), random.normal(1, 3, 9)
        lead = answers.lead_of(Standing("a", dict(enumerate(one))), Standing("b", {seed + 50: x for seed, x in enumerate(two)}))
        self.assertAlmostEqual(lead.p, stats.ttest_ind(two, one, equal_var=False).pvalue, places=12)

    def test_so_many_more_seeds_as_are_asked_for_tell_it_four_times_in_five(self):
        for effect in [0.4, 1.0, 2.5]:
            random = numpy.random.default_rng(6)
            seeds = answers.seeds_needed(effect)
            trials = 1000
            differences = random.normal(effect, 1.0, (trials, seeds))
            p = [answers.lead_of(Standing("a", dict.fromkeys(range(seeds), 0.0)), Standing("b", dict(enumerate(row)))).p
                 for row in differences]
            share = numpy.mean(numpy.array(p) < answers.LEVEL)
            # 4 deviations of a share of 0.8 among so many; the last seed can add much where there are few.
            self.assertGreater(share, 0.8 - 4 * math.sqrt(0.16 / trials), effect)
            self.assertLess(answers.power_of(effect, seeds - 1) if seeds > 2 else 0.0, answers.POWER)

    def test_numbers_of_seeds_are_those_of_tables_of_the_paired_test(self):
        # Cohen's effects, 80% power at 5% two-sided, as G*Power has them: 0.2 small, 0.5 medium, 0.8 large.
        self.assertEqual([answers.seeds_needed(effect) for effect in [0.2, 0.5, 0.8, 1.0]], [199, 34, 15, 10])
        # Where the normal distribution takes over, below 0.0886, there is no step.
        self.assertAlmostEqual(answers.seeds_needed(0.0887) / answers.seeds_needed(0.0885), 1, delta=0.01)
        self.assertEqual(answers.seeds_needed(0.0), answers.MOST_SEEDS + 1)

    def test_one_seed_tells_nothing_and_equal_images_are_the_same(self):
        one = verdict_of([Standing("a", {1: 1.0}), Standing("b", {1: 2.0})])
        self.assertEqual((one.verdict, one.more_seeds), (answers.ONE_SEED, None))
        same = verdict_of([Standing("a", {1: 1.0, 2: 3.0}), Standing("b", {1: 1.0, 2: 3.0})])
        self.assertEqual((same.verdict, same.more_seeds), (answers.SAME, None))
        self.assertEqual(verdict_of([Standing("a", {1: 1.0})]).verdict, answers.ALONE)

    def test_the_best_must_lead_over_all_and_not_over_the_next_alone(self):
        noise = numpy.array([5.0, -5.0, 3.0, -3.0])
        found = verdict_of([Standing("a", dict.fromkeys(range(4), 1.0)), Standing("b", dict.fromkeys(range(4), 1.5)),
                            Standing("c", dict(enumerate(2.0 + noise)))])
        self.assertEqual((found.verdict, found.tied), (answers.CANNOT_TELL, ["c"]))
        self.assertRegex(answering.verdict_text(found), r"^cannot tell from c \(lead 41")    # the root of 2, and no more
        self.assertGreater(found.more_seeds, 1)


class Budgets(InFolder):
    """A pass of either takes 0.25 s (and the first 0.01 s more); the fast method falls as 1/n, the other stays."""

    def scene(self, seeds=(1, 2, 3, 4), spread=0.01, **settings):
        made = synthetic.rows(lambda seed, number, component: (1 + spread * (seed - 2.5)) / max(1, number), seeds=seeds, **settings)
        made += synthetic.rows(lambda seed, number, component: 0.11 * (1 + spread * ((seed * 7) % 5 - 2)), seeds=seeds,
                               **synthetic.PM_RADIUS, **settings)
        synthetic.write_csv(self.results, made)
        return self.read().scenes()[0]

    def test_the_best_at_each_budget_is_the_one_with_the_least_error(self):
        found = {(one.unit, one.budget): one for one in answers.answers_of(self.scene())}
        self.assertEqual([budget for unit, budget in found if unit == "passes"], [1, 4, 16, 64])
        self.assertEqual(found["passes", 4].best.label, "PM, radius")
        self.assertEqual(found["passes", 16].best.label, "PPM")
        self.assertEqual({one.verdict for one in found.values()}, {answers.TOLD})
        self.assertAlmostEqual(found["passes", 16].best.mean, 1 / 16)
        relative, error = answers.relative_lead(found["passes", 16])
        self.assertAlmostEqual(relative, math.sqrt(0.11 * 16) - 1, delta=0.01)
        self.assertLess(error, 0.02)

    def test_seconds_between_passes_follow_the_curve_and_keep_the_spread(self):
        scene = self.scene(spread=0.2)
        found = answers.answers_of(scene, budgets={"seconds": [3.01]})    # 12 passes of 0.25 s
        errors = next(standing for standing in [found[0].best, *found[0].others] if standing.label == "PPM").by_seed
        for seed, error in errors.items():
            self.assertAlmostEqual(error * 12 / (1 + 0.2 * (seed - 2.5)), 1, delta=0.01)

    def test_a_seed_that_was_slow_is_not_as_far_at_the_same_seconds(self):
        made = synthetic.rows(lambda seed, number, component: 1 / max(1, number), seeds=[1, 2])
        for row in made:
            row["seconds"] = str(float(row["seconds"]) * float(row["seed"]))
        synthetic.write_csv(self.results, made)
        curves = answers.seed_curves(self.read().rows.query("component == 'total'"))
        errors = answers.at_seconds(curves, 4.0)
        self.assertAlmostEqual(errors[2] / errors[1], 2, delta=0.01)

    def test_nothing_is_extrapolated(self):
        scene = self.scene()
        for budgets, why in [({"seconds": [0.1]}, "less than one pass"), ({"seconds": [100]}, "more than recorded"),
                             ({"passes": [3]}, "not recorded"), ({"passes": [128]}, "more than recorded")]:
            found, = answers.answers_of(scene, budgets=budgets)
            self.assertIsNone(found.best)
            self.assertEqual(set(found.left_out.values()), {why})

    def test_the_best_of_each_group_competes(self):
        made = []
        for alpha, mse in [("0.5", 1.0), ("0.7", 1.1)]:
            made += synthetic.rows(lambda seed, number, component: mse + 0.001 * seed, alpha=alpha)
        made += synthetic.rows(lambda seed, number, component: 2.0 - 0.001 * seed, **synthetic.PM_RADIUS)
        synthetic.write_csv(self.results, made)
        found = answers.answers_of(self.read().scenes()[0], budgets={"passes": [64]}, between="integrator")
        self.assertEqual([found[0].best.label, *(other.label for other in found[0].others)], ["PPM, α = 0.5", "PM, radius"])


class Command(InFolder):
    write = Budgets.scene

    def test_the_table_says_what_is_told_and_what_would_be_needed(self):
        self.write()
        said = self.output_of("answer")
        self.assertRegex(said, r"16 passes +PPM +0\.25\d* ± ")
        self.assertIn("over PM, radius", said)
        self.assertIn("decomposition = true", said)
        rows = self.table("answers.csv")
        self.assertEqual({row["verdict"] for row in rows}, {"told"})

    def test_one_seed_is_answered_as_far_as_it_goes(self):
        self.write(seeds=[1])
        said = self.output_of("answer")
        self.assertRegex(said, r"cannot tell from PM, radius \(lead [\d.]+%\): with one seed nothing is known of the spread")
        self.assertIn("`seeds = 4`", said)

    def test_a_lead_that_cannot_be_told_says_how_many_more_seeds_would(self):
        self.write(spread=0.8)
        self.assertRegex(self.output_of("answer", "--passes", 8), r"cannot tell from .* \(lead .*%\); \d+ more seeds? would")

    def test_without_errors_it_says_what_to_do(self):
        made = synthetic.rows(lambda *_: 1.0)
        for row in made:
            row.update(mse="", mse_unbiased="", rmse="", reference_floor="")
        synthetic.write_csv(self.results, made)
        self.assertIn("make a reference", self.output_of("answer"))

    def test_budgets_scenes_methods_and_groups_are_asked_for_and_refused_by_name(self):
        self.write()
        self.assertIn("4 s", self.output_of("answer", "--seconds", 4))
        self.assertFalse((self.results / "answers.csv").exists())
        self.assertIn("no other method", self.output_of("answer", "--methods", "PPM*"))
        self.assertIn("expected one of PM, radius; PPM", self.refusal_of("answer", "--methods", "SPPM"))
        self.assertIn("expected a setting", self.refusal_of("answer", "--between", "seed"))
        self.assertIn(r"\toprule", self.output_of("answer", "--table", "latex"))
        self.assertIn("| --- |", self.output_of("answer", "--table", "markdown"))


if __name__ == "__main__":
    unittest.main()
