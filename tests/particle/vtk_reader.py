# SPDX-License-Identifier: GPL-3.0-or-later
"""Check one particle file: vtk_reader.py FILE RANKS PARTICLES_PER_RANK (see test_vtk_reader.sh).

The file is the one of test_vtkhdf --write: rank r has PARTICLES_PER_RANK + r particles, or none."""
import sys

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

path, ranks, each = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
n = sum(each + r for r in range(ranks)) if each else 0

errors = []
reader = vtk.vtkHDFReader()
reader.AddObserver("ErrorEvent", lambda *args: errors.append(args))
assert reader.CanReadFile(path), "vtkHDFReader refuses the file"
reader.SetFileName(path)
reader.Update()
assert not errors, "vtkHDFReader reports an error"
grid = reader.GetOutputDataObject(0)
assert grid.IsA("vtkUnstructuredGrid"), grid.GetClassName()
assert grid.GetNumberOfPoints() == n, grid.GetNumberOfPoints()
assert grid.GetNumberOfCells() == n, grid.GetNumberOfCells()

with h5py.File(path, "r") as f:
    root, data = f["VTKHDF"], f["VTKHDF/PointData"]
    assert list(root.attrs["Version"]) == [1, 0]
    assert root.attrs["Type"] == b"UnstructuredGrid"
    assert data["velocity"].attrs["unit"] == b"m/s"
    assert data["radius"].attrs["meaning"] == b"radius"
    assert root["Points"].attrs["unit"] == b"m"
    assert data["id"].dtype == np.int64 and data["velocity"].shape == (n, 3)
    assert sorted(data) == ["code", "id", "radius", "velocity"], sorted(data)
    assert list(f["Restart/NumberOfParticles"]) == [each + r if each else 0 for r in range(ranks)]
    want = {name: data[name][...] for name in data}
    points = root["Points"][...]

time = vtk_to_numpy(grid.GetFieldData().GetArray("TimeValue"))
assert time.tolist() == [0.25], time
if n:
    assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), points)
    assert np.all((points >= 0) & (points < 1)) and np.ptp(points) > 0.5
    for k in range(n):
        cell = grid.GetCell(k)
        assert cell.GetCellType() == vtk.VTK_VERTEX and cell.GetPointId(0) == k
    for name, array in want.items():
        got = vtk_to_numpy(grid.GetPointData().GetArray(name))
        assert got.dtype == array.dtype, (name, got.dtype)
        assert np.array_equal(got, array, equal_nan=array.dtype == float), name
    ids = np.arange(n)
    for r in range(ranks):  # the writer adds 2^60 to the second id of each rank
        ids[sum(each + q for q in range(r)) + 1] += 2**60
    assert np.array_equal(want["id"], ids), "ids"
