#!/usr/bin/python3
"""Fields in other formats: result.vtu is result.vtkhdf to the last bit but for the order of cells, as VTK and meshio read it;
result.frd, read column by column as the format of CalculiX is described, has its nodes, elements and values to the digits that
it holds."""
import os
import pathlib
import unittest

import harness
from harness import cgcontact, scene, settings

try:
    import h5py
    import meshio
    import numpy as np
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
except ImportError as missing:
    h5py = None
    WHY = f"{missing}; install python3-h5py, python3-meshio, python3-scipy and python3-vtk9"

DIGITS = 6e-6  # relative: five digits behind the point of the first one
ALL = {"output__vtu": "true", "output__frd": "true", "output__plots": "false"}


def columns(line, *widths):
    """The fields of a line, as long as their widths say."""
    places = [sum(widths[:k]) for k in range(len(widths) + 1)]
    return [line[begin:end] for begin, end in zip(places, places[1:])]


def values_of(line, first=13, width=12):
    return [float(line[k:k + width]) for k in range(first, len(line.rstrip("\n")), width)]


class Frd:
    """A result file of CalculiX: nodes, elements (type, group, nodes) and datasets by name (node: values)."""

    def __init__(self, path):
        self.header, self.nodes, self.elements, self.datasets, self.components = [], {}, [], {}, {}
        lines = iter(pathlib.Path(path).read_text().splitlines())
        for line in lines:
            if line.startswith("    1C") or line.startswith("    1U"):
                self.header.append(line)
            elif line.startswith("    2C"):
                self.read_nodes(line, lines)
            elif line.startswith("    3C"):
                self.read_elements(line, lines)
            elif line.startswith("  100C"):
                self.read_dataset(line, lines)
            elif line == " 9999":
                assert next(lines, None) is None, "9999 is the last line"
                return
            else:
                assert line.startswith("    1PSTEP"), line
        raise AssertionError("no 9999")

    @staticmethod
    def rows(lines):
        for line in lines:
            if line == " -3":
                return
            yield line
        raise AssertionError("no -3")

    def read_nodes(self, line, lines):
        _, number, _, form = columns(line, 24, 12, 37, 1)
        assert form == "1"
        for row in self.rows(lines):
            assert row[:3] == " -1" and len(row) == 13 + 36, row
            self.nodes[int(row[3:13])] = values_of(row)
        assert int(number) == len(self.nodes)

    def read_elements(self, line, lines):
        _, number, _, form = columns(line, 24, 12, 37, 1)
        assert form == "1"
        rows = self.rows(lines)
        for row in rows:
            mark, element, kind, group, material = columns(row, 3, 10, 5, 5, 5)
            assert mark == " -1" and int(element) == len(self.elements) + 1 and group == material
            mark, nodes = columns(next(rows), 3, 80)
            assert mark == " -2"
            self.elements.append((int(kind), int(group), [int(nodes[k:k + 10]) for k in range(0, len(nodes), 10)]))
        assert int(number) == len(self.elements)

    def read_dataset(self, line, lines):
        name_of_set, _, number, _, kind, step, _, form = columns(line[6:], 6, 12, 12, 20, 2, 5, 10, 2)
        assert (name_of_set, int(kind), int(step), form) == ("L  101", 0, 1, " 1")
        mark, name, count, _ = columns(next(lines), 5, 8, 5, 5)
        assert mark == " -4  "
        components = []
        for _ in range(int(count)):
            mark, component, *_, exists = columns(next(lines), 5, 8, 5, 5, 5, 5, 5)
            assert mark == " -5  "
            if exists == "    0":  # else readers compute it
                components.append(component.strip())
        values = {}
        for row in self.rows(lines):
            assert row[:3] == " -1"
            values[int(row[3:13])] = values_of(row)
            assert len(values[int(row[3:13])]) == len(components), row
        assert int(number) == len(values)
        self.components[name.strip()], self.datasets[name.strip()] = components, values


@unittest.skipIf(h5py is None, "" if h5py else WHY)
class Formats(unittest.TestCase):
    def solve(self, name, **values):
        outcome = cgcontact("run", scene(name), "--out", name, *settings(**ALL, **values))
        self.assertEqual(outcome.code, 0, outcome.err)
        return pathlib.Path(name)

    def test_vtu_is_vtkhdf(self):
        """Points, cells and every array of both files, in VTK's order of components."""
        directory = self.solve("two_solids_3d", n=6)
        for stem in ("result", "contact"):
            with h5py.File(directory / f"{stem}.vtkhdf") as file:
                group = file["VTKHDF"]
                reader = vtkXMLUnstructuredGridReader()
                reader.SetFileName(str(directory / f"{stem}.vtu"))
                reader.Update()
                grid = reader.GetOutput()
                np.testing.assert_array_equal(vtk_to_numpy(grid.GetPoints().GetData()), group["Points"])
                types, corners = np.array(group["Types"]), np.split(group["Connectivity"], group["Offsets"][1:-1])
                order = np.argsort(-types.astype(int), kind="stable")  # cells of one type follow each other
                np.testing.assert_array_equal(vtk_to_numpy(grid.GetCells().GetConnectivityArray()),
                                              np.concatenate([corners[k] for k in order]))
                np.testing.assert_array_equal(vtk_to_numpy(grid.GetCells().GetOffsetsArray()),
                                              np.cumsum([0] + [len(corners[k]) for k in order]))
                np.testing.assert_array_equal(vtk_to_numpy(grid.GetCellTypesArray()), types[order])
                by_meshio = meshio.read(directory / f"{stem}.vtu")
                np.testing.assert_array_equal(by_meshio.points, group["Points"])
                for kind, data in (("PointData", grid.GetPointData()), ("CellData", grid.GetCellData())):
                    self.assertEqual({data.GetArrayName(k) for k in range(data.GetNumberOfArrays())}, set(group[kind]))
                    for name in group[kind]:
                        of_vtkhdf = np.array(group[kind][name])
                        np.testing.assert_array_equal(vtk_to_numpy(data.GetArray(name)),
                                                      of_vtkhdf[order] if kind == "CellData" else of_vtkhdf, name)
                for name in group["PointData"]:
                    np.testing.assert_array_equal(by_meshio.point_data[name], group["PointData"][name])
                # As docs/scene.md says for Code_Aster, which wants one block of cells of each type.
                meshio.write(f"{stem}.med", by_meshio)
                med = meshio.read(f"{stem}.med")
                self.assertEqual(sorted((block.type, len(block.data)) for block in med.cells),
                                 sorted((block.type, len(block.data)) for block in by_meshio.cells))

    def test_frd(self):
        """A refined grid of two bodies, one of them without contact on most of its nodes."""
        directory = self.solve("ball_on_plate", accuracy__pressure='"10 %"')
        frd = Frd(directory / "result.frd")
        self.assertIn("    1UMAT    2ball", [line.rstrip() for line in frd.header])
        with h5py.File(directory / "result.vtkhdf") as file:
            group = file["VTKHDF"]
            points, body = np.array(group["Points"]), np.array(group["CellData/body"])
            ids, offsets = np.array(group["Connectivity"]), np.array(group["Offsets"])
            fields = {"DISP": np.array(group["PointData/displacement"], dtype=float),
                      "STRESS": np.array(group["PointData/stress_recovered"], dtype=float)[:, [0, 1, 2, 3, 4, 5]]}
            types = np.array(group["Types"])
        self.assertEqual(list(frd.nodes), list(range(1, len(points) + 1)))
        self.assertLess(np.abs(np.array(list(frd.nodes.values())) - points).max() / np.abs(points).max(), DIGITS)
        self.assertEqual(len(frd.elements), len(types))
        for k, (kind, of_group, nodes) in enumerate(frd.elements):
            self.assertEqual(kind, {12: 1, 10: 3}[types[k]])
            self.assertEqual(of_group, body[k] + 1)
            self.assertEqual([node - 1 for node in nodes], ids[offsets[k]:offsets[k + 1]].tolist())
        self.assertEqual(frd.components["DISP"], ["D1", "D2", "D3"])
        self.assertEqual(frd.components["STRESS"], ["SXX", "SYY", "SZZ", "SXY", "SYZ", "SZX"])
        for name, field in fields.items():
            difference = np.abs(np.array(list(frd.datasets[name].values())) - field).max() / np.abs(field).max()
            self.assertLess(difference, DIGITS, name)
        self.check_contact(frd, directory, points)

    def check_contact(self, frd, directory, points):
        """CONTACT: the values of contact.vtkhdf on nodes at the same places; none where nothing lies opposite."""
        with h5py.File(directory / "contact.vtkhdf") as file:
            group = file["VTKHDF"]
            places, data = np.array(group["Points"]), group["PointData"]
            expected = {tuple(x): row for x, *row in zip(
                places.tolist(), data["gap_smooth"], data["pressure_sprc_smooth"], data["pressure_error_smooth"])
                if np.isfinite(row[0])}
        self.assertEqual(frd.components["CONTACT"], ["COPEN", "CPRESS", "CPERROR"])
        contact = frd.datasets["CONTACT"]
        largest = max(row[1] for row in expected.values())
        self.assertGreater(largest, 0)
        self.assertGreaterEqual(len(contact), len(expected))  # both bodies may have a point at one place
        for node, row in contact.items():
            self.assertIn(tuple(points[node - 1]), expected)
            self.assertTrue(all(np.isfinite(row)))
        found = max(contact.values(), key=lambda row: row[1])
        self.assertLess(abs(found[1] / largest - 1), DIGITS)

    def test_bodies_are_of_one_piece(self):
        """The planes and cylinders of a CAD solid go on beyond its faces: what they cut off outside of it is no cell of the result (at
        n = 4 seven groups of 14 to 99 cells)."""
        outcome = cgcontact("run", scene("lug"), "--out", "lug", *settings(n=4, output__plots="false", output__report="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        with h5py.File("lug/result.vtkhdf") as file:
            group = file["VTKHDF"]
            ends, corners = np.array(group["Offsets"])[1:], np.array(group["Connectivity"])
            first = np.repeat(corners[np.concatenate([[0], ends[:-1]])], np.diff(np.concatenate([[0], ends])))
            size = group["Points"].shape[0]
            links = coo_matrix((np.ones(len(corners)), (first, corners)), shape=(size, size))
            pieces, of_point = connected_components(links, directed=False)
            self.assertEqual(len(np.unique(of_point[corners])), 2)

    def test_only_what_is_asked_for(self):
        """Without VTKHDF; nothing of the way there is left; unknown values are refused."""
        outcome = cgcontact("run", scene("two_solids_3d"), "--out", "few",
                            *settings(n=4, output__vtk="false", output__plots="false", output__vtu="true", output__csv="false",
                                      output__report="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(sorted(os.listdir("few")), ["contact.vtu", "report.json", "result.vtu"])
        outcome = cgcontact("run", scene("two_solids_3d"), "--out", "none", *settings(output__frd="2"))
        self.assertEqual(outcome.code, 1)
        self.assertIn("output.frd", outcome.err)


if __name__ == "__main__":
    harness.main()
