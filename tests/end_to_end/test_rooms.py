#!/usr/bin/python3
"""The README.md of every source folder names its files and sub-folders, each once, and nothing else.

Names stand in backquotes before the first colon of the items of its list: "- `a.hpp`, `b.cpp`: what they are". A header
stands for the .cpp of the same name; a sub-folder ends with "/".
"""
import collections
import re
import unittest

import harness

LONGEST = 26  # lines: to be read in one look
NOT_NAMED = ("README.md", "CMakeLists.txt")


def named(text):
    """The names in a README, and the item in which each stands."""
    items = re.findall(r"^- (`[^:]*):", text, re.M)
    return collections.Counter(name for item in items for name in re.findall(r"`([^`]+)`", item))


def there(folder):
    """The names that a README has to have."""
    files = {file.name for file in folder.iterdir() if file.is_file() and file.name not in NOT_NAMED}
    rooms = {room.name + "/" for room in folder.iterdir() if room.is_dir()}
    return {name for name in files if not (name.endswith(".cpp") and name[:-3] + "hpp" in files)} | rooms


class Rooms(unittest.TestCase):
    def test_every_room_names_its_files(self):
        folders = [harness.SOURCE / name for name in ("core", "kernels", "recovery", "contact")]
        folders += [room for folder in folders for room in sorted(folder.rglob("*")) if room.is_dir()]
        self.assertGreater(len(folders), 20)
        problems = []
        for folder in folders:
            place = f"{folder.relative_to(harness.SOURCE)}/README.md"
            readme = folder / "README.md"
            if not readme.is_file():
                problems.append(f"{place} is missing: what enters, what leaves, one item for each of {sorted(there(folder))}")
                continue
            text = readme.read_text()
            names = named(text)
            problems += [f'{place}: add "- `{name}`: what it is"' for name in sorted(there(folder) - set(names))]
            problems += [f"{place}: take out `{name}`, which is not there" for name in sorted(set(names) - there(folder))]
            problems += [f"{place}: `{name}` stands in {count} items" for name, count in names.items() if count > 1]
            if text.count("\n") > LONGEST:
                problems.append(f"{place}: {text.count(chr(10))} lines, at most {LONGEST}")
            if not re.search(r"^In(?: and out)?: ", text, re.M):
                problems.append(f'{place}: say what enters and what leaves ("In: ... Out: ...")')
        self.assertEqual(problems, [], "\n" + "\n".join(problems))


if __name__ == "__main__":
    harness.main()
