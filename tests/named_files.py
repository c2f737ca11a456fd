"""Files that pages and comments name are there: every mention of the form folder/file.cpp (.h, .py, .toml, .md) is the end of the
path of a file of the repository, or leads to one from where it stands."""

import os
import re
import subprocess
import sys

MENTION = re.compile(r"(?<![\w/.-])((?:[\w-]+/)+(?!NAME)[\w-]+\.(?:cpp|h|py|toml|md))\b")
OTHERS = {"src/integrators/mean.cpp", "embree4/rtcore.h", "glass/README.md"}  # what a recipe makes, a library has, a user makes


def ends_of(path):
    parts = path.split("/")
    return {"/".join(parts[i:]) for i in range(len(parts))}


def main():
    files = subprocess.check_output(["git", "ls-files"], text=True).splitlines()
    known = set().union(*map(ends_of, files)) | OTHERS
    missing = []
    for file in files:
        if not file.endswith((".cpp", ".h", ".md")):
            continue
        with open(file, encoding="utf-8") as lines:
            for number, line in enumerate(lines, 1):
                missing += [
                    f"{file}:{number}: {name} is not in the repository"
                    for name in MENTION.findall(line)
                    if not line.startswith("#include") and name not in known
                    and not os.path.exists(os.path.join(os.path.dirname(file), name))
                ]
    print(*missing, sep="\n")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
