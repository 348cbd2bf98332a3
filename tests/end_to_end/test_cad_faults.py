#!/usr/bin/python3
# timeout: 400
# backend: serial
"""CAD files with random faults: every one is a scene or one message that names it, within a minute. On the
serial backend: a file is read in a process of its own that has one thread on every backend."""
import pathlib
import random
import re

import harness
import step_files
from cad_parts import Inspected
from harness import cgcontact


def changed(text, chance):
    """A file with one to four faults: lines and characters that are gone, moved or others, other references, numbers,
    entities."""
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        lines = text.split("\n")
        place = chance.randrange(len(text))
        kind = chance.randrange(8)
        if kind == 0:
            del lines[chance.randrange(len(lines))]
            text = "\n".join(lines)
        elif kind == 1:
            a, b = chance.randrange(len(lines)), chance.randrange(len(lines))
            lines[a], lines[b] = lines[b], lines[a]
            text = "\n".join(lines)
        elif kind == 2:
            text = text[:place] + chr(chance.randrange(256)) + text[place + 1:]
        elif kind == 3:
            text = text[:place] + text[place + chance.randrange(1, 60):]
        elif kind == 4:
            text = text[:max(place, 1)]
        else:
            pattern = {5: r"#\d+", 6: r"(?<=[(,])-?\d+\.\d*(?:E[+-]?\d+)?", 7: r"[A-Z_]{5,}"}[kind]
            found = list(re.finditer(pattern, text))
            if not found:
                continue
            old, other = chance.choice(found), chance.choice(found).group()
            if kind == 6:
                other = chance.choice(("0.", "-1.", "1.E30", "1.E-30", "1.E308", "1.E7", "NaN", "$", "*", "9999999999"))
            text = text[:old.start()] + other + text[old.end():]
    return text or " "


class Faults(Inspected):
    def test_random_faults_of_step_files(self):
        """300 files with faults: none ends the program, hangs it or writes two messages. OpenCASCADE crashes on some of
        them, else the test proves nothing."""
        parts = [pathlib.Path("parts") / f"{name}.step"
                 for name in ("assembly", "bearing", "cross_drilled", "filleted", "lofted", "lug", "spline_pin", "tip",
                              "torus")]
        texts = [file.read_text() for file in parts]
        texts += [step_files.boxes(((0, 0, 0), (10, 20, 30)), annotated=True)] * 3
        texts += [step_files.boxes(((0, 0, 0), (10, 20, 30)), ((10, 0, 0), (10, 20, 30)))] * 3
        tally = {}
        for number in range(300):
            chance = random.Random(number)
            file = pathlib.Path(f"fault{number}.step")
            file.write_bytes(changed(chance.choice(texts), chance).encode("latin-1"))
            ended = self.told(cgcontact("init", file), file)
            tally[ended] = tally.get(ended, 0) + 1
            file.unlink()
        print(tally)
        self.assertGreater(tally.get("crashed", 0), 0, tally)
        self.assertGreater(tally.get("read", 0), 0, tally)

    def test_random_faults_of_other_formats(self):
        """60 IGES and BREP files with faults each."""
        for name in ("box.igs", "box.brep"):
            text = (pathlib.Path("parts") / name).read_text()
            for number in range(60):
                chance = random.Random(number)
                file = pathlib.Path(f"fault{number}_{name}")
                file.write_bytes(changed(text, chance).encode("latin-1"))
                self.told(cgcontact("init", file, *(["--unit", "mm"] if name.endswith("brep") else [])), file)
                file.unlink()


if __name__ == "__main__":
    harness.main()
