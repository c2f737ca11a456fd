"""What is read of a results folder is what was written: whatever byte of it changes is refused with the name of its file."""

import json
import random
import shutil
import tempfile
import threading
import time
import unittest
from pathlib import Path

from photonlab.records import ensembles, files, images, kept_files
from support import stamps, whole_results
from support.in_folder import InFolder

RUN, POINT = "cornell-box_default_seed-1", "cornell-box_default"


class KeptFiles(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.sound = Path(cls.folder.name) / "sound"
        whole_results.make(cls.sound)
        stamps.stamp(cls.sound)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.sound, self.results, dirs_exist_ok=True)

    def changed_files(self, file):
        """The file with one bit changed, at both ends and at 40 places by chance."""
        sound, chance = file.read_bytes(), random.Random(3)
        for place in [0, len(sound) - 1, *(chance.randrange(len(sound)) for _ in range(40))]:
            file.write_bytes(sound[:place] + bytes([sound[place] ^ 1 << chance.randrange(8)]) + sound[place + 1:])
            yield place

    def test_a_sound_folder_is_drawn_by_every_command(self):
        for name in whole_results.COMMANDS:
            self.output_of(name)

    def test_every_byte_of_a_snapshot_counts(self):
        file = self.results / f"runs/{RUN}/snapshots/pass-000032.exr"
        sound = file.read_bytes()
        snapshot = self.read().run(RUN).snapshots[32]
        for _ in self.changed_files(file):
            with self.assertRaisesRegex(files.InputError, f"^{file}: is not what was written: its checksum is another; move "
                                        f"{file.parents[1]} away and run the experiment again"):
                images.read_image(snapshot)
        file.write_bytes(sound[:-1])
        self.assertIn(f"{file}: has {len(sound) - 1} bytes, and had {len(sound)} when it was written; move", self.refusal_of("report"))
        file.unlink()
        for name in ["strip", "gallery", "grid", "equal_time", "report"]:
            self.assertIn(f"{file}: cannot be read: No such file", self.refusal_of(name) if name != "equal_time" else self.equal_time())

    def equal_time(self):
        (self.results / "decomposition.csv").unlink(missing_ok=True)
        return self.refusal_of("equal_time")

    def test_every_byte_of_a_sum_counts(self):
        file = self.results / f"ensembles/{POINT}/slot-01.exr"
        said = f"{file}: is not what was written: its checksum is another; remove it and run the experiment again"
        for _ in self.changed_files(file):
            with self.assertRaisesRegex(files.InputError, f"^{said}"):
                ensembles.read_slot(file, f"key-of-{POINT}")
        for name in ["decomposition", "fits"]:
            self.assertIn(said, self.refusal_of(name))

    def test_sums_of_other_settings_are_refused(self):
        stamps.seal(self.results / f"ensembles/{POINT}/slot-01.exr", "another-key")
        self.assertIn("slot-01.exr: its sums are of other settings than ensemble.json", self.refusal_of("decomposition"))
        shutil.rmtree(self.results / f"ensembles/{POINT}")
        shutil.copytree(self.sound / f"ensembles/{POINT}", self.results / f"ensembles/{POINT}")
        file = self.results / f"runs/{RUN}/run.json"
        stamps.change(file, ensemble={"folder": "x", "key": "another"})
        self.assertIn(f"holds sums of other settings than run {RUN}", self.refusal_of("decomposition"))

    def test_rows_that_are_changed_or_gone_are_refused_with_what_brings_them_back(self):
        file = self.results / "iterations.csv"
        sound = file.read_text()
        lines = sound.splitlines(keepends=True)
        for damaged in ["".join(lines[:9] + lines[10:]), "".join(lines[:-24]), sound.replace("0.001", "0.002", 1), sound + lines[-1]]:
            file.write_text(damaged)
            for name in ["convergence", "report", "decomposition"]:
                said = self.refusal_of(name)
                self.assertIn(f"{file}: is not what was merged from the runs: its checksum is another; run the experiment again, which "
                              "makes nothing anew that is as it was", said)
        (self.results / "merged.json").unlink()    # the runs know their rows too
        file.write_text("".join(lines[:9] + lines[10:]))
        self.assertIn(f"{file}: the rows of {RUN} are of another making of this run", self.refusal_of("report"))

    def test_probes_that_are_changed_or_foreign_are_refused(self):
        file = self.results / "probes.csv"
        file.write_text("".join(file.read_text().splitlines(keepends=True)[:-1]))
        self.assertIn(f"{file}: is not what was merged", self.refusal_of("probes"))

    def test_descriptions_that_are_changed_are_refused(self):
        for file, name in [(self.results / "merged.json", "convergence"), (self.results / f"runs/{RUN}/run.json", "strip"),
                           (self.results / f"runs/{RUN}/run.json", "report"),
                           (self.results / f"ensembles/{POINT}/ensemble.json", "fits")]:
            sound = file.read_bytes()
            for _ in self.changed_files(file):
                with self.assertRaisesRegex(files.InputError, f"^{file}: is not what was written: its checksum is another; x"):
                    kept_files.read_json(file, "x", must_be_checked=True)
            self.assertIn(f"{file}: is not what was written: its checksum is another", self.refusal_of(name))
            file.write_bytes(sound)

    def test_a_run_that_was_made_anew_since_is_not_mixed_with_older_rows(self):
        folder = self.results / f"runs/{RUN}"
        (folder / "iterations.csv").write_text((folder / "iterations.csv").read_text().replace("0.26", "0.27"))
        listed = json.loads((folder / "run.json").read_text())["files"]
        stamps.change(folder / "run.json", files={**listed, "iterations.csv": stamps.stamp_of(folder / "iterations.csv")})
        for name in ["strip", "report", "decomposition"]:
            self.assertIn(f"the rows of {RUN} are of another making of this run than what is in {folder}", self.refusal_of(name))

    def test_a_table_that_is_being_replaced_is_read_again(self):
        file = self.results / "iterations.csv"
        sound = file.read_text()
        file.write_text(sound.replace("0.001", "0.002", 1))    # of a merge whose merged.json is read before it is renamed
        def finish():
            time.sleep(0.1)
            files.replace_file(file, sound)
        thread = threading.Thread(target=finish)
        thread.start()
        found = self.read()
        thread.join()
        self.assertEqual(found.hash, kept_files.hash_of(sound.encode()))
        self.assertTrue(found.has_stamps)

    def test_a_half_of_the_reference_that_is_changed_is_refused(self):
        self.name_reference("key-64")
        self.output_of("strip")
        half = self.results / "reference/half_b.exr"
        half.write_bytes(half.read_bytes()[:-1] + b"x")
        for name in ["strip", "decomposition", "report", "gallery", "grid"]:
            self.assertIn(f"{half}: is not what was written: its checksum is another; bring the reference back", self.refusal_of(name))

    def name_reference(self, key):
        """reference.json as it is, and a run.json that names this key."""
        reference = self.results / "reference"
        (reference / "reference.json").write_text(json.dumps({
            "key": "key", "samples_per_half": 64,
            "checksums": {half: stamps.stamp_of(reference / f"{half}.exr")["hash"] for half in ["half_a", "half_b"]}}))
        for file in self.results.glob("runs/*/run.json"):
            stamps.change(file, working_directory=str(self.results), reference={"path": "reference", "key": key})
        for file in self.results.glob("ensembles/*/ensemble.json"):
            stamps.change(file, working_directory=str(self.results))

    def test_a_reference_that_has_grown_since_is_not_the_one_of_the_errors(self):
        self.name_reference("key-32")
        self.assertIn("reference is another one than the errors in the records are against, so no difference",
                      self.output_of("strip"))
        self.assertIn("its reference reference is another one than the errors", self.refusal_of("decomposition"))
        self.output_of("report")
        self.assertIn("the reference reference is another one than the errors in the records are against.",
                      (self.results / "report.html").read_text())

    def test_a_folder_of_another_experiment_than_its_rows_is_refused(self):
        (self.results / "experiment.json").write_text('{"schema": 1, "experiment": "other"}')
        self.assertIn("iterations.csv:2: is of the experiment made-up; experiment.json says that the folder is that of other",
                      self.refusal_of("convergence"))

    def test_tables_and_figures_of_other_records_are_refused_or_not_shown(self):
        for name in ["decomposition", "convergence", "fits"]:
            self.output_of(name)
        file = self.results / "iterations.csv"
        file.write_text(file.read_text().replace("0.26", "0.27"))
        for run in self.results.glob("runs/*"):
            shutil.rmtree(run)
        stamps.write_merged(self.results)
        for name in ["bias_variance", "equal_time"]:
            self.assertIn("decomposition.csv: was made from other records than those in iterations.csv; run `photonlab analyse decomposition` again",
                          self.refusal_of(name))
        self.output_of("report")
        text = (self.results / "report.html").read_text()
        for name in ["figures/convergence-cornell-box.png", "decomposition.csv", "fits.csv"]:
            self.assertIn(f"<li>{name}: was not made from the records that are here now", text)


if __name__ == "__main__":
    unittest.main()
