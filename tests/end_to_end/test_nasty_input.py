#!/usr/bin/python3
"""Scenes and triangle files that users really make: each ends with exit code 1, one message, at once, nothing written."""
import os
import pathlib
import struct
import subprocess
import unittest

import harness
from harness import cgcontact

PROMISED_SECONDS, LOAD_FACTOR = 1.0, 30.0 if harness.SLOW_BUILD else 3.0

BLOCK = '{name = "block", box = {min = [0, 0, 0], max = [1, 1, 1]}}'
GOOD = f"""[[body]]
name = "lower"
shape = {BLOCK}
material = {{E = 200e9, nu = 0.3}}
cell_size = 0.21

[[body]]
name = "upper"
shape = {{name = "block", box = {{min = [0, 0, 1], max = [1, 1, 2]}}}}
material = {{E = 70e9, nu = 0.2}}
cell_size = 0.17

[[support]]
face = "lower.block.z-"
displacement = {{x = 0, y = 0, z = 0}}

[[support]]
face = "upper.block.x-"
symmetry = true

[[support]]
face = "upper.block.y-"
symmetry = true

[[load]]
face = "upper.block.z+"
pressure = 1e6

[[contact]]
faces = ["lower.block.z+", "upper.block.z-"]
"""


def changed(old, new):
    assert GOOD.count(old) == 1, old
    return GOOD.replace(old, new)


def lower_shape(shape):
    return GOOD.replace(f"shape = {BLOCK}", f"shape = {shape}", 1)


def pressure(expression):
    return changed("pressure = 1e6", f'pressure = "{expression}"')


# Name of the scene: its text, and what the message must say.
SCENES = {
    # Encodings and files.
    "utf16": (GOOD.encode("utf-16"), ["utf16.toml:1", "UTF-16", "UTF-8"]),
    "latin1": ('title = "Zylinder \u00fc"\n'.encode("latin1") + GOOD.encode(), ["latin1.toml:1", "utf-8"]),
    "too_long": (b"# " + (20 << 20) * b"x", ["too large for a scene", "16 MB"]),
    # Units and sizes.
    "millimetres": (changed("min = [0, 0, 0], max = [1, 1, 1]", "min = [0, 0, 0], max = [1e3, 1e3, 1e3]"),
                    ["millimetres.toml:5", "cell_size = 0.21", "more than 2e9 cells", "1e+03 x 1e+03 x 1e+03 m"]),
    "cell_larger_than_body": (changed("cell_size = 0.21", "cell_size = 5"),
                              ["cell_larger_than_body.toml:5", "cell_size = 5", "more than the whole body", "1 x 1 x 1 m"]),
    "far_from_the_origin": (lower_shape(BLOCK[:-1] + ", translate = [1e9, 0, 0]}"),
                            ["cell_size = 0.21", "1e+09 m from the origin"]),
    "huge_body": (changed("max = [1, 1, 1]", "max = [1e308, 1e308, 1e308]"), ["more than 2e9 cells", "7.9e+304"]),
    "flat_body": (changed("max = [1, 1, 1]", "max = [1, 1, 1e-300]"), ["body[0] = \"lower\"", "empty"]),
    "modulus_tiny": (changed("E = 200e9", "E = 5e-324"), ["modulus_tiny.toml:4", "E = 5e-324", "1e-9 to 1e21 Pa"]),
    "modulus_huge": (changed("E = 200e9", "E = 1e300"), ["E = 1e+300", "out of range", "1e-9 to 1e21 Pa"]),
    "modulus_nan": (changed("E = 200e9", "E = nan"), ["E = nan", "not finite", "> 0 Pa"]),
    "modulus_date": (changed("E = 200e9", "E = 2020-01-01"), ["modulus_date.toml:4", "a date or time, not a number"]),
    "integer_too_long": (changed("E = 200e9", "E = 99999999999999999999"), ["integer_too_long.toml:4", "64 bits"]),
    "length_infinite": (changed("max = [1, 1, 1]", "max = [1, inf, 1]"), ["box.max[1] = inf", "not finite"]),
    "pressure_infinite": (changed("pressure = 1e6", "pressure = -inf"), ["load[0].pressure = -inf", "not finite"]),
    "kappa_huge": (GOOD + "[solver]\nkappa = 1e300\n", ["solver.kappa = 1e+300", "1e-3 to 1e6"]),
    "tolerance_tiny": (GOOD + "[solver]\ntolerance = 1e-300\n", ["solver.tolerance = 1e-300", ">= 1e-15 and < 1"]),
    "ghost_penalty_huge": (GOOD + "[solver]\nghost_penalty = 1e9\n", ["ghost_penalty", "0 to 1000"]),
    # Contact and supports.
    "swapped_faces": (changed('"lower.block.z+", "upper.block.z-"', '"lower.block.z-", "upper.block.z+"'),
                      ["contact[0] = \"lower-upper\"", "within reach", "see each other"]),
    "faces_that_never_meet": (changed("min = [0, 0, 1], max = [1, 1, 2]", "min = [5, 0, 1], max = [6, 1, 2]"),
                              ["contact[0] = \"lower-upper\"", "within reach"]),
    "same_pair_twice": (GOOD + '[[contact]]\nname = "again"\nfaces = ["upper.block.z-", "lower.block.z+"]\n',
                        ["contact[1].faces", "the pair \"lower-upper\" again"]),
    "interference_in_wrong_unit": (GOOD + "interference = 10\n", ["contact[0].interference = 10", "1 m long"]),
    "reach_infinite": (GOOD + "search_distance = inf\n", ["search_distance = inf", "not finite"]),
    "support_on_contact": (GOOD + '[[support]]\nface = "upper.block.z-"\ndisplacement = {z = 0}\n',
                           ["support[3]", '"upper.block.z-"', 'contact "lower-upper"', "contact cannot act"]),
    "supports_that_disagree": (GOOD + '[[support]]\nface = "lower.block.z-"\ndisplacement = {normal = 1e-3}\n',
                               ["support[3]", "0.001 m", "lower.block.z-", "in the same direction"]),
    "path_without_length": (GOOD + "[output]\npath = {from = [1, 0, 0], to = [1, 0, 0]}\n",
                            ["output.path", "has no length"]),
    "same_faces_by_another_name": (
        changed('name = "lower"', 'name = "lower"\nfaces = [{name = "half", surfaces = ["block.z+"], box = {min = [0, 0, 0], max = '
                '[0.5, 1, 2]}}]') + '[[contact]]\nname = "again"\nfaces = ["lower.half", "upper.block.z-"]\n',
        ['contact[1] = "again"', 'm2 of its faces with contact "lower-upper"']),
    "zone_whole": (GOOD + '[reference]\npressure = 1e6\nzones = {whole = "x > 0"}\n', ["reference.zones.whole", "another name"]),
    "zone_without_name": (GOOD + '[reference]\npressure = 1e6\nzones = {"" = "x > 0"}\n', ["no name of a zone"]),
    "reference_without_a_value": (GOOD + '[reference]\npressure = "sqrt(-1-y)"\n', ["reference.pressure"]),
    "body_force_infinite": (changed('name = "lower"', 'name = "lower"\nbody_force = ["1/x", 0, 0]\ngrid = {offset = [0, 0, 0]}'),
                            ["body_force", "1/x"]),
    # Names, pictures and points that are too many or too long: told before the solve.
    "name_of_a_probe_too_long": (GOOD + f'[[probe]]\nname = "{"p" * 101}"\npoint = [0.5, 0.5, 0.5]\n',
                                 ["probe[0].name", "has 101 characters", "at most 100 characters"]),
    "name_of_a_section_too_long": (GOOD + f'[[section]]\nname = "{"s" * 300}"\npoint = [0.5, 0.5, 0.5]\nnormal = [1, 0, 0]\n',
                                   ["section[0].name", "has 300 characters", "at most 100 characters"]),
    "name_of_a_body_too_long": (GOOD.replace('"lower', f'"{"b" * 101}'), ["body[0].name", "at most 100 characters"]),
    "too_many_sections": (GOOD + "".join(f'[[section]]\nname = "s{k}"\npoint = [0.5, 0.5, 0.5]\nnormal = [1, 0, 0]\n' for k in range(1000)),
                          ["section", "has 1000 of them", "at most 100 [[section]]"]),
    "too_many_probes": (GOOD + "".join(f'[[probe]]\nname = "p{k}"\npoint = [0.5, 0.5, 0.5]\n' for k in range(1001)),
                        ["probe", "has 1001 of them", "at most 1000 [[probe]]"]),
    "too_many_points_of_probes": (
        GOOD + "".join(f'[[probe]]\nname = "p{k}"\nline = {{from = [0, 0, 0], to = [1, 1, 1], points = 100000}}\n' for k in range(11)),
        ['probe[10].name = "p10"', "more points than allowed", "at most 1000000 points of all probes together"]),
    "edge_named_as_an_end": (lower_shape('{extrude = {profile = [[0, 0], {to = [1, 0], name = "top"}, [1, 1]], height = 1}}'),
                             ["profile", '"top" is the name of an end', "another name for the edge"]),
    "reference_is_a_folder": (GOOD + '[reference]\npressure_file = "."\n', ["reference.pressure_file", "no such file"]),
    # Free motions.
    "slides": (changed('[[support]]\nface = "upper.block.y-"\nsymmetry = true\n', ""),
               ['body "upper" is free to move along y:', 'face = "upper.block.y', "symmetry = true"]),
    "slides_and_turns": (changed('[[support]]\nface = "upper.block.y-"\nsymmetry = true\n', "")
                         .replace('[[support]]\nface = "upper.block.x-"\nsymmetry = true\n', ""),
                         ["move along x, to move along y and to rotate about the axis along z through (0.51, 0.51, 1.51)"]),
    "body_in_two_pieces": (lower_shape(f'{{union = [{BLOCK}, {{box = {{min = [3, 3, 3], max = [4, 4, 4]}}}}]}}'),
                           ['body "lower" is in 2 separate pieces', "piece 2, from (2.94, 2.94, 2.94)", "is not held at all"]),
    # Degenerate shapes.
    "all_subtracted": (lower_shape(f"{{difference = [{BLOCK}, {{box = {{min = [-1, -1, -1], max = [2, 2, 2]}}}}]}}"),
                       ["body[0] = \"lower\"", "empty"]),
    "subtracted_from_itself": (lower_shape(f"{{difference = [{BLOCK}, {{box = {{min = [0, 0, 0], max = [1, 1, 1]}}}}]}}"),
                               ["body[0] = \"lower\"", "empty"]),
    "shapes_that_touch": (lower_shape(f"{{intersection = [{BLOCK}, {{sphere = {{center = [2, 0.5, 0.5], radius = 1}}}}]}}"),
                          ["body[0].shape", "is empty"]),
    "negative_radius": (lower_shape('{name = "block", sphere = {center = [0, 0, 0], radius = -1}}'),
                        ["radius = -1", "> 0 m"]),
    "axis_without_length": (lower_shape(BLOCK[:-1] + ", rotate = {axis = [0, 0, 0], angle = 3}}"), ["axis", "length zero"]),
    "moved_out_of_range": (lower_shape(BLOCK[:-1] + ", translate = [1e300, 0, 0]}"), ["body[0].shape", "empty"]),
    # Expressions and nesting.
    "parentheses": (pressure(100000 * "(" + "1" + 100000 * ")"), ["parentheses.toml:27", "((((...", "too long"]),
    "sum_without_end": (pressure("1" + 500000 * "+x"), ["sum_without_end.toml:27", "too long"]),
    "power_tower": (pressure("^".join(3000 * ["2"])), ["power_tower.toml:27", "infinite"]),
    "functions_in_functions": (pressure(3000 * "sin(" + "x"), ["functions_in_functions.toml:27", "not a valid expression"]),
    "minus_signs": (pressure(100000 * "-" + "1"), ["minus_signs.toml:27", "too long"]),
    "empty_expression": (pressure(""), ["load[0].pressure = \"\"", "empty"]),
    "expression_with_line_breaks": (changed("pressure = 1e6", "pressure = '''1 +\n\n* 2'''"), ["load[0].pressure", "1 +"]),
    "tables_in_tables": ("a = " + 5000 * "{a=" + "1" + 5000 * "}", ["tables_in_tables.toml:1", "nested"]),
    "key_of_many_parts": (".".join(50000 * ["a"]) + " = 1", ["key_of_many_parts.toml:1", "too many parts", "at most 20"]),
    "table_of_many_parts": ("[" + ".".join(5000 * ["a"]) + "]", ["table_of_many_parts.toml:1", "too many parts"]),
    "circle_of_three": ('[parameters]\na = "b"\nb = "c"\nc = "a"\n' + GOOD, ["circle_of_three.toml:2", "defined by itself"]),
    "many_parameters": ("[parameters]\n" + "".join(f'a{k} = "a{k + 1}"\n' for k in range(5000)) + "a5000 = 1\n" + GOOD,
                        ["many_parameters.toml:1", "too many parameters", "at most 1000"]),
    "empty_name": (changed('name = "upper"', 'name = ""'), ["body[1].name = \"\"", "is empty"]),
    "key_twice": (GOOD.replace('name = "lower"', 'name = "lower"\nname = "other"'), ["key_twice.toml:3", "redefine"]),
}

CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
QUADS = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
TRIANGLES = [t for q in QUADS for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def binary_stl(header=b"part", count=len(TRIANGLES), points=CUBE, triangles=TRIANGLES):
    data = header.ljust(80) + struct.pack("<I", count)
    for t in triangles:
        data += struct.pack("<12fH", 0, 0, 0, *(c for p in t for c in points[p]), 0)
    return data


def ascii_stl(points=CUBE):
    facets = ["facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*points[p]) for p in t) +
              "endloop\nendfacet\n" for t in TRIANGLES]
    return "solid part\n" + "".join(facets) + "endsolid part\n"


def obj(faces, points=CUBE):
    return "".join("v {} {} {}\n".format(*p) for p in points) + "".join(f"f {' '.join(map(str, f))}\n" for f in faces)


def ply(faces, kind="uchar int", count=None, vertices=8):
    return (f"ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(faces) if count is None else count}\nproperty list {kind} vertex_indices\nend_header\n" +
            "".join("{} {} {}\n".format(*p) for p in CUBE) + "".join(f"{' '.join(map(str, f))}\n" for f in faces))


def one_based(faces, shift=1):
    return [[p + shift for p in f] for f in faces]


def with_counts(faces):
    return [[len(f), *f] for f in faces]


SECOND = [(x + 3, y, z) for x, y, z in CUBE]
INSIDE_OUT = [f[::-1] for f in one_based(QUADS, 9)]
BAD_POINT = CUBE[1:]

# Name of the file: its contents, and what the message must say.
SURFACES = {
    "nan.stl": (binary_stl(points=[(float("nan"), 0, 0), *BAD_POINT]), ["triangle 1", "not finite"]),
    "infinite.stl": (binary_stl(points=[(float("-inf"), 0, 0), *BAD_POINT]), ["not finite"]),
    "huge.stl": (binary_stl(points=[tuple(3e38 * c for c in p) for p in CUBE]), ["cell_size", "more than 2e9 cells"]),
    "no_triangles.stl": (binary_stl(count=0, triangles=[]), ["there is no triangle"]),
    "announces_more.stl": (binary_stl(count=13), ["announces 13 facets, 734 bytes, and has 684 bytes", "truncated"]),
    "announces_fewer.stl": (binary_stl(count=11), ["announces 11 facets"]),
    "announces_4e9.stl": (binary_stl(count=2**32 - 1), ["announces 4294967295 facets"]),
    "solid_but_binary.stl": (binary_stl(b"solid part")[:-7], ["announces 12 facets", "truncated"]),
    "text_nan.stl": (ascii_stl([("nan", 0, 0), *BAD_POINT]), ["text_nan.stl:4", '"nan" is not finite']),
    "decimal_comma.stl": (ascii_stl([("0,5", 0, 0), *BAD_POINT]), ["decimal_comma.stl:4", '"0,5" is no number']),
    "half.stl": (ascii_stl()[:500], ["half.stl:", "truncated"]),
    "nothing_in_it.stl": ("solid part\nendsolid part\n", ["there is no triangle"]),
    "empty.obj": ("", ["the file is empty"]),
    "no_faces.obj": (obj([]), ["there is no triangle"]),
    "index_too_large.obj": (obj(one_based(QUADS, 2)), ["index_too_large.obj:10", "vertex 9 of 8"]),
    "index_negative.obj": (obj(one_based(QUADS, -9)), ["index_negative.obj:9", "vertex -9 of 8"]),
    "index_zero.obj": (obj(QUADS), ["index_zero.obj:9", "vertex 0 of 8"]),
    "index_of_20_digits.obj": (obj([[10**20, 1, 2]]), ["index_of_20_digits.obj:9", "is no integer"]),
    "two_corners.obj": (obj([[1, 2]]), ["two_corners.obj:9", "fewer than three corners"]),
    "one_corner_thrice.obj": (obj([[1, 1, 1]]), ["no triangle has an area"]),
    "both_sides_of_a_sheet.obj": (obj([[1, 2, 3], [1, 3, 2]]), ["triangle 1", "triangle 2"]),
    "bent_quad.obj": (obj([[2, 3, 4, 1]], [(0, 0, 0), (2, 0, 0), (0, 1, 0), (2, 2, 0)]), ["bent_quad.obj:5", "crosses itself"]),
    "one_shell_inside_out.obj": (obj(one_based(QUADS) + INSIDE_OUT, CUBE + SECOND), ["1 of 2 shells is inside out"]),
    "picture.obj": (b"\xff\xd8\xff\xe0" + bytes(range(256)) * 20, ["is not a text"]),
    "utf16.obj": (obj(one_based(QUADS)).encode("utf-16"), ["is not a text"]),
    "list_of_strings.ply": (ply(with_counts(QUADS), "uchar string"), ["list_of_strings.ply:8", "unknown type"]),
    "negative_length.ply": (ply([[-4, 0, 1]]), ["negative_length.ply:18", "-4 is no length of a list"]),
    "length_nan.ply": (ply([["nan", 0, 1]]), ["length_nan.ply:18", "is no length of a list"]),
    "length_without_end.ply": (ply([["1e18", 0, 1]]), ["length_without_end.ply:18", "a number is missing"]),
    "half_an_index.ply": (ply([[3, 0, 1.5, 2]]), ["half_an_index.ply:18", "face 1 refers to vertex 1.5"]),
    "index_out_of_range.ply": (ply([[3, 0, 1, 8]]), ["index_out_of_range.ply:18", "vertex 9 of 8"]),
    "many_faces.ply": (ply(with_counts(QUADS), count=299999999), ["299999999 elements \"face\"", "truncated"]),
    "no_properties.ply": ("ply\nformat binary_little_endian 1.0\nelement vertex 300000000\nend_header\n",
                          ["\"vertex\" have no properties"]),
    "list_of_4e9.ply": (b"ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                        b"property float z\nelement face 1\nproperty list uint uchar vertex_indices\n"
                        b"end_header\n\xff\xff\xff\xff1234", ["truncated"]),
    "no_z.ply": ("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nelement face 1\n"
                 "property list uchar int vertex_indices\nend_header\n0 0\n3 0 0 0\n",
                 ['no element "vertex" with a property "z"']),
    "other_list.ply": (ply(with_counts(QUADS)).replace("vertex_indices", "indices"),
                       ['no element "face" with a property "vertex_indices"']),
    "junk.obj": ("hello world\n" + obj(one_based(QUADS)), ["junk.obj:1", '"hello" is no statement of a polygon mesh']),
    "bezier.obj": (obj(one_based(QUADS)) + "cstype bezier\n", ["bezier.obj:15", '"cstype"', "no statement"]),
    "bad_corner.obj": (obj([["1/abc", 2, 3]]), ["bad_corner.obj:9", '"1/abc" is no corner of a face']),
    "compressed.stl": (b"\x1f\x8b\x08" + bytes(700), ["compressed (gzip)"]),
    "is_ply.stl": (ply(with_counts(QUADS)), ["the content is .ply"]),
    "overlap.obj": (obj(one_based(QUADS) + one_based(QUADS, 9), CUBE + [(x + 0.5, y, z) for x, y, z in CUBE]),
                    ["two shells overlap or lie on each other"]),
    "side_by_side.obj": (obj(one_based(QUADS) + one_based(QUADS, 9), CUBE + [(x + 1, y + 0.3, z) for x, y, z in CUBE]),
                         ["two shells overlap or lie on each other"]),
    "part.step": ("ISO-10303-21;\n", ["unknown kind of file", ".stl, .obj, .ply, .off"]),
}


class Nasty(unittest.TestCase):
    slowest = (0.0, "")

    def refused(self, *arguments, expected=()):
        outcome = cgcontact(*arguments, timeout=60)
        self.assertEqual(outcome.code, 1, outcome.err[:2000])
        self.assertEqual(len(outcome.errors()), 1, outcome.err[:2000])
        self.assertEqual(outcome.err.splitlines()[-1], outcome.errors()[0])
        self.assertLess(len(outcome.err), 4000)
        self.assertEqual(outcome.out, "")
        for text in expected:
            self.assertIn(text, outcome.errors()[0])
        self.assertLess(outcome.seconds, LOAD_FACTOR * PROMISED_SECONDS)
        Nasty.slowest = max(Nasty.slowest, (outcome.seconds, " ".join(map(str, arguments))[:60]))

    def test_the_good_ones(self):
        """The scene that all others are made from is good, also with CRLF and a byte order mark; so is the cube in all
        formats, with quads, negative indices and a binary file that begins with "solid"."""
        for name, text in (("good", GOOD.encode()), ("crlf", GOOD.replace("\n", "\r\n").encode()),
                           ("mark", b"\xef\xbb\xbf" + GOOD.encode()),
                           ("full_stops", ("title = 'wait" + 100 * "." + "'\n" + GOOD).encode())):
            pathlib.Path(f"{name}.toml").write_bytes(text)
            self.assertEqual(cgcontact("check", f"{name}.toml").err, "", name)
        for name, data in (("solid.stl", binary_stl(b"solid part")), ("text.stl", ascii_stl()), ("quads.obj", obj(one_based(QUADS))),
                           ("negative.obj", obj(one_based(QUADS, -8))), ("quads.ply", ply(with_counts(QUADS))),
                           ("mark.obj", b"\xef\xbb\xbf" + obj(one_based(QUADS)).encode()),
                           ("mark.ply", b"\xef\xbb\xbf" + ply(with_counts(QUADS)).encode()),
                           ("comments.obj", obj([[*f, "# a face"] for f in one_based(QUADS)])),
                           ("continued.obj", obj([[*f[:2], "\\\n", *f[2:]] for f in one_based(QUADS)])),
                           ("faces_first.obj", "".join(obj(one_based(QUADS)).splitlines(keepends=True)[8:]) + obj([])),
                           ("touching.obj", obj(one_based(QUADS) + one_based(QUADS, 9), CUBE + [(x + 1, y + 1, z + 1) for x, y, z in CUBE]))):
            self.assertEqual(cgcontact("check", self.scene_with_surface(name, data)).err, "", name)

    def scene_with_surface(self, name, data):
        pathlib.Path(name).write_bytes(data.encode() if isinstance(data, str) else data)
        scene = pathlib.Path(name.replace(".", "_") + ".toml")
        scene.write_text(f'[[body]]\nname = "part"\nmaterial = {{E = 200e9, nu = 0.3}}\ncell_size = 0.21\n'
                         f'shape = {{mesh = {{file = "{name}", unit = "m"}}}}\n'
                         f'[[support]]\nface = "part.mesh"\nsymmetry = true\n')
        return scene

    def test_scenes(self):
        """Checked and run: the message names the file and says what is wrong; nothing is written."""
        for name, (text, expected) in SCENES.items():
            file = f"{name}.toml"
            pathlib.Path(file).write_bytes(text if isinstance(text, bytes) else text.encode())
            with self.subTest(scene=name):
                self.refused("check", file, expected=[file, *expected])
                self.refused("run", file, "--out", "results", expected=[file, *expected])
        self.assertFalse(os.path.exists("results"))
        print(f"{len(SCENES)} scenes, slowest so far {Nasty.slowest[0]:.2f} s: {Nasty.slowest[1]}", flush=True)

    def test_surfaces(self):
        """Triangle files: the message names the scene's line and the file, with the line or triangle in it."""
        for name, (data, expected) in SURFACES.items():
            with self.subTest(surface=name):
                scene = self.scene_with_surface(name, data)
                line = f"{scene}:4: body[0].cell_size" if "cell_size" in expected else f"{scene}:5: body[0].shape.mesh.file"
                self.refused("check", scene, expected=[line, *(e for e in expected if e != "cell_size")])
        print(f"{len(SURFACES)} surfaces, slowest so far {Nasty.slowest[0]:.2f} s: {Nasty.slowest[1]}", flush=True)

    def test_files_in_the_way(self):
        """Links in a circle, folders and unreadable files in the place of scenes and surfaces."""
        for a, b in (("circle", "ring"), ("ring", "circle")):
            for kind in ("toml", "stl"):
                os.symlink(f"{b}.{kind}", f"{a}.{kind}")
        self.refused("check", "circle.toml", expected=["circle.toml", "Too many levels of symbolic links"])
        template = self.scene_with_surface("cube.obj", obj(one_based(QUADS))).read_text()
        for name, text in (("circle.stl", "Too many levels"), ("folder.stl", "folder or device"), ("", "is empty"),
                           ("none.ply", "no such file"), ("file.toml/part.stl", "no such file")):
            pathlib.Path("folder.stl").mkdir(exist_ok=True)
            pathlib.Path("file.toml").write_text(template.replace("cube.obj", name))
            with self.subTest(surface=name):
                self.refused("check", "file.toml", expected=["file.toml:5", text])
        pathlib.Path("secret.toml").write_text(GOOD)
        os.chmod("secret.toml", 0)
        if os.geteuid() != 0:  # root may read everything
            self.refused("check", "secret.toml", expected=["secret.toml", "Permission denied"])
        self.assertEqual(cgcontact("check", "file.toml", "--set", "body.part.shape.mesh.file=cube.obj").code, 0)

    def test_options(self):
        """--set and --vary without bounds, nonsense values."""
        pathlib.Path("good.toml").write_text(GOOD)
        self.refused("check", "good.toml", "--set", ".".join(5000 * ["a"]) + "=1", expected=["too many parts"])
        self.refused("check", "good.toml", "--set", "title=" + 50000 * "[", "--set", "body.lower.cell_size=" + 20000 * "(",
                     expected=["--set"])
        for text in ("", "=", "n", "n=", "n=,", "n=a,b", "n=1,1", "n=nan", "cell=1,2", "n=1e999"):
            with self.subTest(vary=text):
                self.refused("study", "good.toml", "--vary", text, "--out", "study", expected=["--vary"])
        for text in ("0", "-1", "x", "1e9", ""):
            with self.subTest(repeat=text):
                self.refused("study", "good.toml", "--repeat", text, "--out", "study", expected=["--repeat"])
        self.assertFalse(os.path.exists("study"))

    def test_standard_output_is_full(self):
        """What cannot be printed is an error."""
        pathlib.Path("good.toml").write_text(GOOD)
        with open("/dev/full", "w") as full:
            done = subprocess.run([harness.PROGRAM, "check", "good.toml"], stdout=full, stderr=subprocess.PIPE, text=True,
                                  check=False)
        self.assertEqual((done.returncode, done.stderr),
                         (1, "cgcontact: cannot write to standard output: No space left on device\n"))

    def test_enough_of_them(self):
        """With those in tests/bad_scenes."""
        scenes = len(list((harness.SOURCE / "tests" / "bad_scenes").glob("*.toml")))
        self.assertGreaterEqual(scenes + len(SCENES) + len(SURFACES), 140)


if __name__ == "__main__":
    harness.main()
