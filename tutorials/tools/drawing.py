# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures with VTK: colour tables, spheres and other glyphs, surfaces, captions. Needs a display: etc/withDisplay."""
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk


def colours(low, high, stops):
    """Colour table through the stops (red, green, blue from 0 to 1)."""
    function = vtk.vtkColorTransferFunction()
    for k, stop in enumerate(stops):
        function.AddRGBPoint(low + (high - low) * k / (len(stops) - 1), *stop)
    return function


BLUES = ((0.97, 0.98, 1.0), (0.62, 0.79, 0.88), (0.19, 0.51, 0.74), (0.03, 0.19, 0.42))
DIVERGING = ((0.13, 0.40, 0.67), (0.57, 0.77, 0.87), (0.97, 0.97, 0.97), (0.96, 0.65, 0.51), (0.70, 0.09, 0.17))


def glyphs(points, source, scale=None, directions=None, colour=(0.93, 0.69, 0.27)):
    data = vtk.vtkPolyData()
    cloud = vtk.vtkPoints()
    cloud.SetData(numpy_to_vtk(np.ascontiguousarray(points, float), deep=True))
    data.SetPoints(cloud)
    mapper = vtk.vtkGlyph3DMapper()
    mapper.SetInputData(data)
    mapper.SetSourceConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    for name, values in (('scale', scale), ('direction', directions)):
        if values is not None:
            array = numpy_to_vtk(np.ascontiguousarray(values, float), deep=True)
            array.SetName(name)
            data.GetPointData().AddArray(array)
    mapper.SetScaleArray('scale')
    mapper.SetScaleModeToScaleByMagnitude()
    if directions is not None:
        mapper.SetOrientationArray('direction')
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*colour)
    actor.GetProperty().SetSpecular(0.25)
    return actor


def bar(table, title):
    actor = vtk.vtkScalarBarActor()
    actor.SetLookupTable(table)
    actor.SetTitle(title)
    actor.SetNumberOfLabels(5)
    actor.SetLabelFormat('%.4g')
    actor.UnconstrainedFontSizeOn()
    for text in (actor.GetTitleTextProperty(), actor.GetLabelTextProperty()):
        text.SetColor(0.1, 0.1, 0.1)
        text.SetFontSize(18)
        text.ItalicOff()
        text.BoldOff()
        text.ShadowOff()
    return actor


def caption(text, x, y, size=20):
    actor = vtk.vtkTextActor()
    actor.SetInput(text)
    actor.GetTextProperty().SetColor(0.1, 0.1, 0.1)
    actor.GetTextProperty().SetFontSize(size)
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(x, y)
    return actor


def save(window, path):
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


def new_window(width, height):
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(4)
    window.SetSize(width, height)
    return window


def spheres(centres, diameters, values=None, table=None, colour=(0.93, 0.69, 0.27), resolution=14):
    """Spheres, coloured by values through a table of colours(), or in one colour."""
    source = vtk.vtkSphereSource()
    source.SetThetaResolution(resolution)
    source.SetPhiResolution(resolution)
    actor = glyphs(centres, source, diameters, colour=colour)
    if values is not None:
        mapper = actor.GetMapper()
        array = numpy_to_vtk(np.ascontiguousarray(values, float), deep=True)
        array.SetName('value')
        mapper.GetInput().GetPointData().AddArray(array)
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray('value')
        mapper.SetLookupTable(table)
        mapper.UseLookupTableScalarRangeOn()
        mapper.ScalarVisibilityOn()
    return actor


def triangles(corners, colour=(0.55, 0.6, 0.65), opacity=1.0):
    """A surface of triangles [n][3][3]."""
    corners = np.asarray(corners, float).reshape(-1, 3)
    data, points, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(corners), deep=True))
    for k in range(0, len(corners), 3):
        cells.InsertNextCell(3, [k, k + 1, k + 2])
    data.SetPoints(points)
    data.SetPolys(cells)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*colour)
    actor.GetProperty().SetOpacity(opacity)
    actor.GetProperty().SetAmbient(0.6)
    actor.GetProperty().SetDiffuse(0.4)
    return actor


def view(window, actors, viewport, focus, position, up=(0, 0, 1), angle=20.0, parallel=None):
    """A part of the window with a camera; parallel: half its height in m, without perspective."""
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.SetViewport(*viewport)
    for actor in actors:
        renderer.AddActor(actor)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*position)
    camera.SetViewUp(*up)
    camera.SetViewAngle(angle)
    if parallel:
        camera.ParallelProjectionOn()
        camera.SetParallelScale(parallel)
    renderer.ResetCameraClippingRange()
    return renderer
