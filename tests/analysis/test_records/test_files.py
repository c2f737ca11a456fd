"""What is no ordinary file is refused at once, and a file is replaced wholly or not at all."""

import errno
import os
import resource
import signal
import subprocess
import sys
import unittest
from unittest import mock

from photonlab import command_line
from photonlab.records import files
from support import ANALYSIS, in_folder

# What a process of its own begins with; end() does some work as a command does.
IN_A_PROCESS = f"""import sys
sys.path.insert(0, {str(ANALYSIS)!r})
from photonlab import command_line
from photonlab.records import files
end = lambda work: command_line.run(lambda: command_line.answered(work))
"""


class InFolder(in_folder.InFolder):
    def setUp(self):
        super().setUp()
        self.folder = self.results
        self.file = self.folder / "table.csv"

    def refusal(self, function, *arguments):
        with self.assertRaises(files.InputError) as caught:
            function(*arguments)
        return str(caught.exception)


class Reading(InFolder):
    def test_what_is_no_ordinary_file_is_refused_by_name(self):
        os.mkfifo(self.file)
        self.assertEqual(self.refusal(files.read_text, self.file), f"{self.file}: expected a file, this is a pipe or a device")
        self.assertEqual(self.refusal(files.read_text, self.folder), f"{self.folder}: expected a file, this is a folder")
        self.assertIn("this is a pipe or a device", self.refusal(files.read_bytes, "/dev/zero"))
        self.assertIn("cannot be read: No such file", self.refusal(files.read_bytes, self.folder / "none"))
        self.assertIn("cannot be read: File name too long", self.refusal(files.read_bytes, self.folder / ("x" * 256)))
        self.assertRegex(self.refusal(files.read_bytes, self.folder / "a\0b"), "cannot be read: .*embedded null")    # as this Python says it

    def test_a_link_to_a_pipe_is_a_pipe_and_a_dangling_one_is_there(self):
        os.mkfifo(self.folder / "pipe")
        self.file.symlink_to("pipe")
        self.assertIn("this is a pipe", self.refusal(files.read_text, self.file))
        (self.folder / "dangling").symlink_to("nowhere")
        self.assertTrue(files.is_there(self.folder / "dangling"))

    def test_a_file_of_the_kernels_is_not_waited_for(self):
        if os.path.exists("/proc/kmsg") and os.access("/proc/kmsg", os.R_OK):
            self.assertEqual(files.read_bytes("/proc/kmsg"), b"")
        self.assertEqual(files.read_bytes("/proc/self/environ"), b"")

    def test_what_is_there_is_told_from_what_cannot_be_asked_for(self):
        os.mkfifo(self.file)
        self.assertTrue(files.is_there(self.file))
        self.assertFalse(files.is_there(self.folder / "none"))
        self.assertFalse(files.is_there(self.file / "below"))
        for name in ["x" * 256, "a\0b"]:
            self.assertIn("cannot be read", self.refusal(files.is_there, self.folder / name))

    def test_text_is_utf_8_and_json_can_be_written_again(self):
        self.file.write_bytes(b"caf\xe9")
        self.assertEqual(self.refusal(files.read_text, self.file), f"{self.file}: is not text in UTF-8: byte 4 is no part of it")
        for text in ["", "{", "[" * 100_000, '"\\udce9"', '{"a\\ud800": 1}', "1" * 5000]:
            self.file.write_text(text)
            self.assertIn("table.csv: is not JSON", self.refusal(files.read_json, self.file), text[:10])

    def test_a_file_that_is_too_large_is_not_read(self):
        with open(self.file, "wb") as stream:
            stream.truncate(files.LARGEST_TEXT + 1)
        self.assertIn("expected at most 2147483648 bytes, got 2147483649", self.refusal(files.read_text, self.file))


class Writing(InFolder):
    def assert_only(self, *names):
        self.assertEqual(sorted(os.listdir(self.folder)), sorted(names))

    def test_a_file_is_made_with_its_folder_and_replaced(self):
        file = self.folder / "a/b/table.csv"
        for data in ["old", b"new"]:
            self.assertEqual(files.replace_file(file, data), file)
        self.assertEqual(file.read_bytes(), b"new")
        self.assertEqual(os.listdir(file.parent), ["table.csv"])

    def test_a_link_is_replaced_and_not_followed(self):
        (self.folder / "other").write_text("mine")
        self.file.symlink_to("other")
        files.replace_file(self.file, "new")
        self.assertEqual(((self.folder / "other").read_text(), self.file.read_text()), ("mine", "new"))
        self.assertFalse(self.file.is_symlink())

    def test_permissions_are_those_of_any_new_file(self):
        before = os.umask(0o027)
        self.addCleanup(os.umask, before)
        self.assertEqual(files.replace_file(self.file, "x").stat().st_mode & 0o777, 0o640)

    def test_files_that_only_look_like_leftovers_stay(self):
        names = ["a.partial-0123456789abcde", "a.partial-0123456789abcdefg", "a.partial-0123456789ABCDEF", "apartial-0123456789abcdef"]
        for name in names:
            (self.folder / name).write_text("mine")
        (self.folder / "a\n.partial-0123456789abcdef").write_text("left")
        files.replace_file(self.file, "x")
        self.assert_only("table.csv", *names)

    def test_a_name_of_255_bytes_is_written_and_one_more_is_refused(self):
        files.replace_file(self.folder / ("x" * 255), "x")
        self.assertIn("cannot be written: File name too long", self.refusal(files.replace_file, self.folder / ("x" * 256), "x"))
        self.assert_only("x" * 255)

    def test_a_full_disk_leaves_what_was_there(self):
        self.file.write_text("old")
        for call in ["fsync", "replace"]:
            with mock.patch(f"os.{call}", side_effect=OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))):
                self.assertEqual(self.refusal(files.replace_file, self.file, "new"),
                                 f"{self.file}: cannot be written: No space left on device")
            self.assertEqual(self.file.read_text(), "old")
            self.assert_only("table.csv")

    def test_a_folder_and_a_file_in_place_of_a_folder_are_refused(self):
        self.file.mkdir()
        self.assertIn("table.csv: cannot be written: Is a directory", self.refusal(files.replace_file, self.file, "x"))
        (self.folder / "figures").write_text("x")
        self.assertIn("a.png: cannot be written: ", self.refusal(files.replace_file, self.folder / "figures/a.png", "x"))
        self.assert_only("figures", "table.csv")

    def in_another_process(self, code, **options):
        return subprocess.Popen([sys.executable, "-c", f"{IN_A_PROCESS}file = {str(self.file)!r}\n{code}"], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, **options)

    def test_a_limit_on_the_size_of_files_leaves_what_was_there(self):
        self.file.write_text("old")
        process = self.in_another_process("end(lambda: files.replace_file(file, 'x' * 100_000))",
                                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)))
        output, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, output, errors), (2, "", f"{self.file}: cannot be written: File too large\n"))
        self.assertEqual(self.file.read_text(), "old")
        self.assert_only("table.csv")

    def test_a_process_that_is_ended_leaves_nothing_of_its_own(self):
        self.file.write_text("old")
        for number in [signal.SIGTERM, signal.SIGINT, signal.SIGHUP]:
            # It waits on the way to the disk, when the new file is written under its temporary name.
            process = self.in_another_process("import os, time\nos.fsync = lambda _: (print('there', flush=True), time.sleep(60))\n"
                                              "end(lambda: files.replace_file(file, 'new'))")
            self.addCleanup(process.kill)
            self.assertEqual(process.stdout.readline(), "there\n")
            self.assertEqual(len(os.listdir(self.folder)), 2)
            process.send_signal(number)
            _, errors = process.communicate(timeout=60)
            self.assertEqual((process.returncode, errors), (128 + number, ""))
            self.assertEqual(self.file.read_text(), "old")
            self.assert_only("table.csv")

    def test_a_process_that_is_killed_leaves_what_was_there_under_its_name(self):
        self.file.write_text("old")
        process = self.in_another_process("import os, time\nos.fsync = lambda _: (print('there', flush=True), time.sleep(60))\n"
                                          "files.replace_file(file, 'new')")
        self.assertEqual(process.stdout.readline(), "there\n")
        files.replace_file(self.folder / "beside.csv", "x")
        self.assertEqual(len(os.listdir(self.folder)), 3)    # what is being written is left alone
        process.kill()
        process.communicate(timeout=60)
        self.assertEqual(self.file.read_text(), "old")
        files.replace_file(self.file, "new")
        self.assertEqual(self.file.read_text(), "new")
        self.assert_only("beside.csv", "table.csv")


class Commands(InFolder):
    def outcome(self, work):
        return in_folder.run(main=lambda _: command_line.answered(work))

    def test_mistakes_are_one_line_and_exit_code_2(self):
        def refuse():
            raise files.InputError("a.csv: is\nnot right")
        self.assertEqual(self.outcome(refuse), (2, "", "a.csv: is not right\n"))
        self.assertEqual(self.outcome(lambda: os.rmdir("/nowhere")), (2, "", "/nowhere: No such file or directory\n"))

    def test_an_output_that_is_full_is_said_and_one_that_nobody_reads_is_not(self):
        code = f"{IN_A_PROCESS}end(lambda: print('x' * 100_000))"
        with open("/dev/full", "w") as full:
            done = subprocess.run([sys.executable, "-c", code], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stderr), (2, "the standard output cannot be written: No space left on device\n"))
        read, write = os.pipe()
        os.close(read)
        done = subprocess.run([sys.executable, "-c", code], stdout=write, stderr=subprocess.PIPE, text=True, timeout=60)
        os.close(write)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_names_that_no_terminal_can_show_are_written_as_codes(self):
        code = f"{IN_A_PROCESS}end(lambda: print('caf\\udce9, α'))"
        for encoding, expected in [("utf-8", "caf\\udce9, α\n"), ("ascii", "caf\\udce9, \\u03b1\n")]:
            done = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, timeout=60,
                                  env={**os.environ, "PYTHONIOENCODING": encoding})
            self.assertEqual((done.returncode, done.stdout.decode()), (0, expected))


if __name__ == "__main__":
    unittest.main()
