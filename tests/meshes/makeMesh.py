#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write constant/polyMesh of an OpenFOAM case: a box of hexes, prisms, tetrahedra or polyhedra.

    makeMesh.py CASE --kind tet --cells 7 7 16 --length 0.112 0.112 0.256 --cyclic z --wall x y \\
                --shear 27 --rotate 1 1 0 20 --jitter 0.1

The box is first divided in `--cells` hexes; then
    hex    keeps them;
    prism  cuts each in two triangular prisms (extruded along z);
    tet    cuts each in six tetrahedra along its main diagonal (Kuhn), so the mesh is the same in every hex;
    poly   takes the dual of the tet mesh: one cell per lattice point, 14 faces (hexagons, quadrilaterals) inside.
           Planar faces without jitter, warped faces with it.
Then the lattice points are jittered, the box is scaled, sheared, rotated and moved to the origin, in this order.
All of it is affine except the jitter, which keeps boundary points, so opposite sides stay translates of each other
and any pair can be cyclic.

Patches xMin xMax yMin yMax zMin zMax. An option --wall, --patch, --cyclic, --empty or --symmetry takes axes (x: both
sides) or patch names (xMin); patches not named are of type patch. Internal faces are written in upper-triangular order.
"""
import argparse
import itertools
import os
import sys

import numpy as np

PATCHES = ("xMin", "xMax", "yMin", "yMax", "zMin", "zMax")
TYPES = {"wall": "wall", "patch": "patch", "cyclic": "cyclic", "empty": "empty", "symmetry": "symmetryPlane"}


# ------------------------------------------------------------------------------ cells from the lattice

class Lattice:
    """Points (i, j, k), 0 <= i <= n[0] and so on; index() numbers them with i fastest."""

    def __init__(self, n):
        self.n = tuple(n)
        self.stride = np.array((1, n[0] + 1, (n[0] + 1) * (n[1] + 1)))

    def index(self, ijk):
        return int(self.stride @ np.asarray(ijk))

    def points(self):
        axes = [np.arange(m + 1.0) for m in self.n]
        k, j, i = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
        return np.column_stack((i.ravel(), j.ravel(), k.ravel()))

    def hexes(self):
        return itertools.product(*(range(m) for m in reversed(self.n)))  # (k, j, i), i fastest


def hex_cells(lattice):
    """List of cells; a cell is a list of faces, a face a tuple of point indices."""
    corner = [lattice.index(c) for c in itertools.product((0, 1), repeat=3)]  # index 4 i + 2 j + k
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return [[tuple(lattice.index((i, j, k)) + corner[v] for v in side) for side in sides]
            for k, j, i in lattice.hexes()]


def prism_cells(lattice):
    cells = []
    up = lattice.index((0, 0, 1))
    for k, j, i in lattice.hexes():
        a, b, c, d = (lattice.index((i + di, j + dj, k)) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
        for tri in ((a, b, c), (a, c, d)):
            quads = [(tri[m], tri[(m + 1) % 3], tri[(m + 1) % 3] + up, tri[m] + up) for m in range(3)]
            cells.append([tri[::-1], tuple(v + up for v in tri)] + quads)
    return cells


def kuhn_tets(lattice):
    """(nTets, 4) point indices: 6 per hex, along the paths from corner 000 to corner 111."""
    paths = []
    for order in itertools.permutations(range(3)):
        at = np.zeros(3, int)
        path = [0]
        for axis in order:
            at[axis] = 1
            path.append(lattice.index(at))
        paths.append(path)
    base = np.array([lattice.index((i, j, k)) for k, j, i in lattice.hexes()])
    return (base[:, None, None] + np.array(paths)[None]).reshape(-1, 4)


def tet_cells(lattice):
    return [[tuple(t[m] for m in range(4) if m != out) for out in range(4)] for t in kuhn_tets(lattice).tolist()]


# ------------------------------------------------------------------------------ faces from cells

class Face:
    __slots__ = ("points", "owner", "neighbour", "side")

    def __init__(self, points, owner, neighbour=-1, side=-1):
        self.points, self.owner, self.neighbour, self.side = tuple(points), owner, neighbour, side


def faces_of(cells):
    """Pair the faces of the cells; those without partner have neighbour -1."""
    found = {}
    for cell, sides in enumerate(cells):
        for points in sides:
            key = tuple(sorted(points))
            if key in found:
                found[key].neighbour = cell
            else:
                found[key] = Face(points, cell)
    return list(found.values())


def sides_of(points, n):
    """For each point, the set of sides (0..5 as in PATCHES) of the box 0..n that it lies on, as a bit mask."""
    mask = np.zeros(len(points), int)
    for axis in range(3):
        mask |= (points[:, axis] == 0) * (1 << (2 * axis)) | (points[:, axis] == n[axis]) * (2 << (2 * axis))
    return mask


def side_of(mask, face):
    """The side that all points of the face share, or -1."""
    common = np.bitwise_and.reduce(mask[list(face)])
    return int(common).bit_length() - 1 if common else -1


# ------------------------------------------------------------------------------ dual of the tet mesh

def chain(links):
    """Order nodes so that each pair of neighbours is one of the links (a, b, item): (nodes, items, closed)."""
    at = {}
    for a, b, item in links:
        at.setdefault(a, []).append((b, item))
        at.setdefault(b, []).append((a, item))
    ends = sorted(a for a, around in at.items() if len(around) == 1)
    node = ends[0] if ends else links[0][0]
    nodes, items, last = [node], [], None
    while True:
        step = [s for s in at[node] if s[1] != last]
        if not step or (items and len(items) == len(links)):
            return nodes, items, not ends
        node, last = step[0]
        nodes.append(node)
        items.append(last)


class DualPoints:
    """Points of the dual: made on demand, one per tet, boundary triangle, feature edge or corner."""

    def __init__(self, lattice_points):
        self.source, self.index, self.coords = lattice_points, {}, []

    def __call__(self, vertices):
        key = tuple(sorted(vertices))
        if key not in self.index:
            self.index[key] = len(self.coords)
            self.coords.append(self.source[list(key)].mean(axis=0))
        return self.index[key]


def dual_mesh(points, n, tets):
    """Faces and points of the dual: cell = lattice point, face = edge, point = tet (centroid).

    On the boundary the cell is closed with the centroids of the boundary triangles, the middles of the edges of the
    box and its corners, so that the box keeps its shape."""
    mask = sides_of(points, n)
    dual = DualPoints(points)
    around_edge, triangles = {}, {}
    for t, tet in enumerate(tets.tolist()):
        for a, b in itertools.combinations(sorted(tet), 2):
            c, d = (v for v in tet if v not in (a, b))
            around_edge.setdefault((a, b), []).append((c, d, t))
        for out in range(4):
            key = tuple(sorted(tet[:out] + tet[out + 1:]))
            triangles[key] = triangles.get(key, 0) + 1
    boundary = [(tri, side_of(mask, tri)) for tri, count in triangles.items() if count == 1]
    side = dict(boundary)

    faces = []
    for (a, b), links in around_edge.items():
        nodes, items, closed = chain(links)
        polygon = [dual(tets[t].tolist()) for t in items]
        if not closed:
            first, last = (tuple(sorted((a, b, v))) for v in (nodes[0], nodes[-1]))
            polygon = [dual(first)] + polygon + [dual(last)]
            if side[first] != side[last]:
                polygon.append(dual((a, b)))
        faces.append(Face(polygon, a, b))

    at_vertex = {}
    for tri, s in boundary:
        for v in tri:
            a, b = (w for w in tri if w != v)
            at_vertex.setdefault((v, s), []).append((a, b, tri))
    for (v, s), links in at_vertex.items():
        nodes, items, closed = chain(links)
        polygon = [dual(tri) for tri in items]
        if not closed:
            polygon = [dual((v, nodes[0]))] + polygon + [dual((v, nodes[-1]))]
            if bin(mask[v]).count("1") == 3:
                polygon.append(dual((v,)))
        faces.append(Face(polygon, v, side=s))
    return faces, np.array(dual.coords)


# ------------------------------------------------------------------------------ geometry

def jitter(points, n, fraction, empty_axes, seed):
    """Move each inner point by up to `fraction` of the spacing, uniformly; along an empty axis all layers alike."""
    if fraction == 0:
        return points
    shape = (n[2] + 1, n[1] + 1, n[0] + 1, 3)
    move = np.random.default_rng(seed).uniform(-fraction, fraction, shape)
    for axis in range(3):
        layer = 2 - axis  # array axis
        if axis in empty_axes:
            move = np.broadcast_to(move.take([0], axis=layer), shape).copy()
            move[..., axis] = 0
        else:
            index = [slice(None)] * 4
            for end in (0, -1):
                index[layer] = end
                move[tuple(index)] = 0
    return points + move.reshape(-1, 3)


def rotation(axis, degrees):
    """Rodrigues' formula."""
    k = np.asarray(axis, float)
    k = k / np.linalg.norm(k)
    cross = np.array(((0, -k[2], k[1]), (k[2], 0, -k[0]), (-k[1], k[0], 0)))
    t = np.radians(degrees)
    return np.eye(3) + np.sin(t) * cross + (1 - np.cos(t)) * cross @ cross


def affine(args):
    """Matrix that takes lattice coordinates to metres (without the origin)."""
    scale = np.diag(np.asarray(args.length) / np.asarray(args.cells))
    shear = np.eye(3)
    moved, along = ("xyz".index(a) for a in args.shear_axes)
    shear[moved, along] = np.tan(np.radians(args.shear))
    turn = rotation(args.rotate[:3], args.rotate[3]) if args.rotate else np.eye(3)
    return turn @ shear @ scale


def area_vectors(points, faces):
    area = np.zeros((len(faces), 3))
    for f, face in enumerate(faces):
        p = points[list(face.points)]
        area[f] = 0.5 * np.cross(p[1:-1] - p[0], p[2:] - p[0]).sum(axis=0)
    return area


def orient(points, faces, centres):
    """Turn every face so that its area vector points from owner to neighbour, or out of the box."""
    outward = np.vstack((-np.eye(3), np.eye(3)))[[0, 3, 1, 4, 2, 5]]
    out = np.array([centres[f.neighbour] - centres[f.owner] if f.neighbour >= 0 else outward[f.side] for f in faces])
    wrong = np.einsum("ij,ij->i", area_vectors(points, faces), out) < 0
    for face, flip in zip(faces, wrong):
        if flip:
            face.points = face.points[::-1]


# ------------------------------------------------------------------------------ order and cyclic pairs

def upper_triangular(faces):
    for face in faces:
        if face.neighbour >= 0 and face.neighbour < face.owner:
            face.owner, face.neighbour, face.points = face.neighbour, face.owner, face.points[::-1]
    inner = sorted((f for f in faces if f.neighbour >= 0), key=lambda f: (f.owner, f.neighbour))
    sides = [sorted((f for f in faces if f.neighbour < 0 and f.side == s), key=lambda f: f.owner) for s in range(6)]
    assert len(inner) + sum(map(len, sides)) == len(faces), "a boundary face lies on no side of the box"
    return inner, sides


def match_cyclic(points, n, sides, axis):
    """Give the faces of the max side the order and first point of their partners on the min side.

    Lattice coordinates of boundary points are multiples of 1/12 (no jitter there), so integers identify them."""
    def key(p):
        return tuple(int(c) for m, c in enumerate(np.rint(12 * points[p])) if m != axis)

    low, high = sides[2 * axis], sides[2 * axis + 1]
    partner = {key(p): p for face in high for p in face.points}
    by_points = {frozenset(face.points): face for face in high}
    ordered = []
    for face in low:
        image = [partner[key(p)] for p in face.points]
        other = by_points[frozenset(image)]
        other.points = (image[0],) + tuple(image[:0:-1])  # same first point, turned round: both look outwards
        ordered.append(other)
    assert len(ordered) == len(high)
    sides[2 * axis + 1] = ordered


# ------------------------------------------------------------------------------ output

def header(cls, name, note=""):
    return ("FoamFile\n{\n    version     2.0;\n    format      ascii;\n    class       %s;\n%s"
            "    location    \"constant/polyMesh\";\n    object      %s;\n}\n\n" % (cls, note, name))


def write_list(folder, cls, name, items, note=""):
    with open(os.path.join(folder, name), "w") as out:
        out.write(header(cls, name, note) + "%d\n(\n" % len(items))
        out.writelines(item + "\n" for item in items)
        out.write(")\n")


def boundary_entries(sides, types, matrix, args, start):
    entries = []
    for s, name in enumerate(PATCHES):
        lines = ["type            %s;" % types[name], "nFaces          %d;" % len(sides[s]),
                 "startFace       %d;" % start]
        if types[name] == "cyclic":
            # The neighbour's points minus these (checkMesh warns if it is the other way round).
            apart = (-1 if s % 2 else 1) * args.cells[s // 2] * matrix[:, s // 2]
            lines += ["matchTolerance  1e-6;", "neighbourPatch  %s;" % PATCHES[s ^ 1],
                      "transform       translational;", "separationVector (%r %r %r);" % tuple(map(float, apart))]
        entries.append("    %s\n    {\n%s\n    }" % (name, "\n".join("        " + line for line in lines)))
        start += len(sides[s])
    return entries


def write_mesh(args, points, inner, sides, types, matrix):
    folder = os.path.join(args.case, "constant", "polyMesh")
    os.makedirs(folder, exist_ok=True)
    faces = inner + [f for side in sides for f in side]
    metres = points @ matrix.T + np.asarray(args.origin)
    cells = 1 + max(f.owner for f in faces)
    note = "    note        \"nPoints:%d nCells:%d nFaces:%d nInternalFaces:%d\";\n" % (
        len(points), cells, len(faces), len(inner))
    write_list(folder, "vectorField", "points", ["(%r %r %r)" % tuple(p) for p in metres.tolist()])
    write_list(folder, "faceList", "faces", ["%d(%s)" % (len(f.points), " ".join(map(str, f.points))) for f in faces])
    write_list(folder, "labelList", "owner", [str(f.owner) for f in faces], note)
    write_list(folder, "labelList", "neighbour", [str(f.neighbour) for f in inner], note)
    write_list(folder, "polyBoundaryMesh", "boundary", boundary_entries(sides, types, matrix, args, len(inner)))
    return cells


# ------------------------------------------------------------------------------ command line

def patch_types(args, parser):
    types = {}
    for option, foam_type in TYPES.items():
        for word in getattr(args, option) or []:
            names = [word + "Min", word + "Max"] if word in ("x", "y", "z") else [word]
            for name in names:
                if name not in PATCHES:
                    parser.error("--%s %s: not an axis (x y z) or a patch (%s)" % (option, word, " ".join(PATCHES)))
                if name in types:
                    parser.error("--%s %s: patch %s already has type %s" % (option, word, name, types[name]))
                types[name] = foam_type
    for axis in "xyz":
        pair = [types.get(axis + end, "patch") for end in ("Min", "Max")]
        for foam_type in ("cyclic", "empty"):
            if pair.count(foam_type) == 1:
                parser.error("axis %s: %s must be on both sides" % (axis, foam_type))
    return {name: types.get(name, "patch") for name in PATCHES}


def check_empty(args, types, matrix, parser):
    axes = [a for a in range(3) if types[PATCHES[2 * a]] == "empty"]
    for axis in axes:
        name = "xyz"[axis]
        if args.cells[axis] != 1:
            parser.error("empty %s: needs one cell along %s, not %d" % (name, name, args.cells[axis]))
        if not (args.kind == "hex" or (args.kind == "prism" and name == "z")):
            parser.error("empty %s: only with --kind hex, or --kind prism for z" % name)
        others = [matrix[:, b] for b in range(3) if b != axis]
        normal = np.cross(*others)
        if np.sum(np.abs(normal) > 1e-12 * np.linalg.norm(normal)) != 1:
            parser.error("empty %s: OpenFOAM needs the empty sides normal to x, y or z after rotation and shear" % name)
    return axes


def parse(argv):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", help="case folder; constant/polyMesh in it is written")
    parser.add_argument("--kind", choices=("hex", "prism", "tet", "poly"), default="hex")
    parser.add_argument("--cells", type=int, nargs=3, required=True, metavar=("NX", "NY", "NZ"))
    parser.add_argument("--length", type=float, nargs=3, default=(1.0, 1.0, 1.0), metavar=("LX", "LY", "LZ"),
                        help="edges of the box, m (default 1 1 1)")
    parser.add_argument("--origin", type=float, nargs=3, default=(0.0, 0.0, 0.0), metavar=("X", "Y", "Z"))
    parser.add_argument("--shear", type=float, default=0.0, metavar="DEG", help="shear angle, degrees")
    parser.add_argument("--shear-axes", default="xz", metavar="AB", help="move A in proportion to B (default xz)")
    parser.add_argument("--rotate", type=float, nargs=4, metavar=("AX", "AY", "AZ", "DEG"),
                        help="about this axis through the corner xMin yMin zMin, degrees")
    parser.add_argument("--jitter", type=float, default=0.0, metavar="F",
                        help="move inner lattice points at random by up to F of the spacing (0 to 0.25)")
    parser.add_argument("--seed", type=int, default=1, help="of the jitter (default 1)")
    for option, foam_type in TYPES.items():
        parser.add_argument("--" + option, nargs="+", metavar="SIDE", help="axes or patches of type " + foam_type)
    args = parser.parse_args(argv)
    if min(args.cells) < 1:
        parser.error("--cells: each number must be at least 1")
    if min(args.length) <= 0:
        parser.error("--length: each length must be > 0")
    if not 0 <= args.jitter <= 0.25:
        parser.error("--jitter %g: must be in [0, 0.25]" % args.jitter)
    if not abs(args.shear) < 80:
        parser.error("--shear %g: must be in (-80, 80) degrees" % args.shear)
    if sorted(args.shear_axes) not in (["x", "y"], ["x", "z"], ["y", "z"]):
        parser.error("--shear-axes %s: must be two of x y z" % args.shear_axes)
    if args.rotate and not any(args.rotate[:3]):
        parser.error("--rotate: the axis is zero")
    types = patch_types(args, parser)
    return args, types, check_empty(args, types, affine(args), parser)


def build(args, empty_axes):
    """Points (lattice coordinates) and oriented faces with their sides."""
    n = args.cells
    lattice = Lattice(n)
    points = jitter(lattice.points(), n, args.jitter, empty_axes, args.seed)
    if args.kind == "poly":
        centres = points
        faces, points = dual_mesh(points, n, kuhn_tets(lattice))
    else:
        cells = {"hex": hex_cells, "prism": prism_cells, "tet": tet_cells}[args.kind](lattice)
        centres = np.array([points[list({p for f in cell for p in f})].mean(axis=0) for cell in cells])
        faces = faces_of(cells)
        mask = sides_of(points, n)
        for face in faces:
            if face.neighbour < 0:
                face.side = side_of(mask, face.points)
    orient(points, faces, centres)
    return points, faces


def main(argv=None):
    args, types, empty_axes = parse(argv)
    points, faces = build(args, empty_axes)
    inner, sides = upper_triangular(faces)
    for axis in range(3):
        if types[PATCHES[2 * axis]] == "cyclic":
            match_cyclic(points, args.cells, sides, axis)
    cells = write_mesh(args, points, inner, sides, types, affine(args))
    print("%s: %s mesh, %d cells, %d faces, %d points" % (args.case, args.kind, cells,
                                                          len(inner) + sum(map(len, sides)), len(points)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
