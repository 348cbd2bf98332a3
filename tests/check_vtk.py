#!/usr/bin/python3
"""Opens a VTKHDF file with VTK's reader and prints what is in it as key = value lines; fails on what cannot be right.

usage: check_vtk.py FILE [--points N] [--cells N] [--volume V] [--area A] [--bounds x0 x1 y0 y1 z0 z1]
                         [--point-array NAME:COMPONENTS]... [--cell-array NAME:COMPONENTS]... [--may-be-nan NAME]...
                         [--tolerance T]

Exit code 77 (skip) if VTK's Python package is missing (Debian: python3-vtk9).
"""
import argparse
import sys

try:
    from numpy import arange, isin, isnan, sort
    from vtkmodules.vtkCommonCore import vtkVersion
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
    from vtkmodules.vtkIOHDF import vtkHDFReader
    from vtkmodules.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"skipped: {error}; install python3-vtk9 to check VTK files")
    sys.exit(77)


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--points", type=int)
    parser.add_argument("--cells", type=int)
    parser.add_argument("--volume", type=float)
    parser.add_argument("--area", type=float)
    parser.add_argument("--bounds", type=float, nargs=6)
    parser.add_argument("--point-array", action="append", default=[])
    parser.add_argument("--cell-array", action="append", default=[])
    parser.add_argument("--may-be-nan", action="append", default=[], help="array that may hold NaN")
    parser.add_argument("--tolerance", type=float, default=1e-6, help="relative, of volume, area and bounds")
    return parser.parse_args()


def read(file_name):
    """The grid in the file; errors that VTK only prints become failures."""
    problems = []
    reader = vtkHDFReader()
    reader.AddObserver("ErrorEvent", lambda caller, event: problems.append("VTK's reader reports an error"))
    reader.SetFileName(file_name)
    reader.Update()
    return reader.GetOutput(), problems


def size(grid, name):
    """Sum of a measure of all cells (Volume, Area), and its smallest value."""
    measure = vtkCellSizeFilter()
    measure.SetInputData(grid)
    measure.Update()
    values = vtk_to_numpy(measure.GetOutput().GetCellData().GetArray(name))
    return float(values.sum()), float(values.min()) if len(values) else 0.0


def check_cells(grid, problems):
    """Cells must be hexahedra, tetrahedra or triangles of as many different, existing points, and not inside out."""
    points_of_type = {5: 3, 10: 4, 12: 8}
    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    types = vtk_to_numpy(grid.GetCellTypesArray())
    if len(connectivity) and not (0 <= connectivity.min() and connectivity.max() < grid.GetNumberOfPoints()):
        problems.append("a cell has a point that does not exist")
    for kind, count in points_of_type.items():
        first = offsets[:-1][types == kind]
        if not (offsets[1:][types == kind] - first == count).all():
            problems.append(f"a cell of type {kind} has not {count} points")
            continue
        corners = sort(connectivity[first[:, None] + arange(count)], axis=1)
        if (corners[:, 1:] == corners[:, :-1]).any():
            problems.append(f"a cell of type {kind} has a point twice")
    if not isin(types, list(points_of_type)).all():
        problems.append("there are cells of an unexpected type")
    if size(grid, "Volume")[1] < 0:
        problems.append("a cell is inside out")


def check_arrays(data, kind, tuples, expected, may_be_nan, problems):
    """Every array must be finite (but for NaN where that is said) and of full length; those expected must be there."""
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)
        values = vtk_to_numpy(array)
        if array.GetName() in may_be_nan and not isnan(values).all():
            values = values[~isnan(values)]
        print(f"{kind} {array.GetName()} = {array.GetNumberOfComponents()} x {array.GetNumberOfTuples()}"
              f" [{values.min():.9g}, {values.max():.9g}]")
        if array.GetNumberOfTuples() != tuples:
            problems.append(f"{kind} {array.GetName()} has {array.GetNumberOfTuples()} values, not {tuples}")
        if not (abs(values) < 1e300).all():
            problems.append(f"{kind} {array.GetName()} holds values that are not finite")
    for item in expected:
        name, components = item.split(":")
        array = data.GetArray(name)
        if array is None:
            problems.append(f"{kind} {name} is missing")
        elif array.GetNumberOfComponents() != int(components):
            problems.append(f"{kind} {name} has {array.GetNumberOfComponents()} components, not {components}")


def check_value(name, value, expected, scale, problems):
    print(f"{name} = {value}")
    if expected is not None and not abs(value - expected) <= scale:
        problems.append(f"{name} is {value}, expected {expected}")


def main():
    options = arguments()
    grid, problems = read(options.file)
    print(f"VTK = {vtkVersion().GetVTKVersion()}")
    check_value("points", grid.GetNumberOfPoints(), options.points, 0, problems)
    check_value("cells", grid.GetNumberOfCells(), options.cells, 0, problems)
    check_arrays(grid.GetPointData(), "point array", grid.GetNumberOfPoints(), options.point_array, options.may_be_nan,
                 problems)
    check_arrays(grid.GetCellData(), "cell array", grid.GetNumberOfCells(), options.cell_array, options.may_be_nan,
                 problems)
    print("bounds =", *grid.GetBounds())
    check_cells(grid, problems)
    if options.bounds:
        extent = max(options.bounds[2 * k + 1] - options.bounds[2 * k] for k in range(3))
        for k in range(6):
            check_value(f"bound {k}", grid.GetBounds()[k], options.bounds[k], options.tolerance * extent, problems)
    for name, expected in (("Volume", options.volume), ("Area", options.area)):
        if expected is None:
            continue
        total, smallest = size(grid, name)
        check_value(name.lower(), total, expected, options.tolerance * abs(expected), problems)
        if smallest < 0:
            problems.append(f"a cell has the {name.lower()} {smallest}")
    for problem in problems:
        print("WRONG:", problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
