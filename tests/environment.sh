#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# timeout: 120
#
# What the other tests and the tutorials rely on: OpenFOAM, mpirun with more ranks than cores, Python, drawing.

set -u
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
bad=0
verdict() { # name status why
  if [ "$2" = 0 ]; then echo "ok $1"; else echo "not ok $1 $3"; bad=1; fi
}

source etc/bashrc
verdict openfoam $? "etc/bashrc found no OpenFOAM"
blockMesh -help >/dev/null 2>&1
verdict openfoam-runs $? "blockMesh -help fails"
ranks=$(mpirun -np 3 bash -c 'echo rank' | grep -c rank)
[ "$ranks" = 3 ]
verdict mpirun $? "mpirun -np 3 started $ranks ranks"
"$PYTHON" -c 'import numpy, matplotlib, h5py, vtk'
verdict python $? "$PYTHON lacks one of numpy, matplotlib, h5py, vtk"

colours=$(etc/withDisplay "$PYTHON" - <<'PY'
import vtk
source = vtk.vtkSphereSource()
mapper = vtk.vtkPolyDataMapper()
mapper.SetInputConnection(source.GetOutputPort())
actor = vtk.vtkActor()
actor.SetMapper(mapper)
actor.GetProperty().SetColor(1, 0, 0)
actor.GetProperty().LightingOff()
renderer = vtk.vtkRenderer()
renderer.AddActor(actor)
renderer.SetBackground(0, 0, 1)
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(100, 100)
window.AddRenderer(renderer)
window.Render()
grab = vtk.vtkWindowToImageFilter()
grab.SetInput(window)
grab.Update()
image = grab.GetOutput()
print(*[int(image.GetScalarComponentAsDouble(x, x, 0, c)) for x in (2, 50) for c in range(3)])
PY
)
[ "$colours" = "0 0 255 255 0 0" ]
verdict drawing $? "corner and centre are '$colours', not blue and red"

refused=$(DISPLAY='' etc/withDisplay "$PYTHON" - <<'PY'
import ctypes
x11 = ctypes.CDLL('libX11.so.6')
x11.XOpenDisplay.restype = ctypes.c_void_p
x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
refused = 0
for _ in range(200):
    display = x11.XOpenDisplay(None)
    if display:
        x11.XCloseDisplay(display)
    refused += not display
print(refused)
PY
)
[ "$refused" = 0 ]
verdict display $? "the virtual X server refused $refused of 200 clients one after the other"
exit $bad
