# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed forms the tutorials compare with: spheres in water in columns of cells. SI units.

The block cases are one-dimensional: layers of equal spheres at heights z, cells of one height. What a
layer puts into a cell is a spherical cap (two faces at most meet a sphere), so porosity, drag and balance of
forces can be written down for the porosity that the solver deposits, without a simulation.

Drag: Di Felice (1994) with Dalla Valle's coefficient, as in Markauskas et al. (2017), eq. 19, 21, 22.
"""
import numpy as np

G = 9.81


def sphere(d):
    return np.pi / 6 * d ** 3


def di_felice(w, d, eps, rho=1000.0, mu=1e-3):
    """Drag on one sphere, N; w = eps |u - v| > 0 is the superficial slip, m/s. Markauskas eq. 19 is written
    with |u - v|, which gives eps^(2 - chi) for the eps^(-chi) here."""
    re = rho * w * d / mu
    chi = 3.7 - 0.65 * np.exp(-(1.5 - np.log10(re)) ** 2 / 2)
    return np.pi / 8 * (0.63 + 4.8 / np.sqrt(re)) ** 2 * rho * d ** 2 * w ** 2 * eps ** -chi


def root(rising, lo, hi):
    """Where a rising function is zero, lo > 0, by bisection."""
    for _ in range(100):
        mid = np.sqrt(lo * hi)
        lo, hi = (mid, hi) if rising(mid) < 0 else (lo, mid)
    return lo


def cap_weights(z, d, faces):
    """[spheres][cells] share of each sphere (centre z, diameter d) between consecutive heights of faces."""
    h = np.clip(np.asarray(faces)[None, :] - (np.asarray(z)[:, None] - d / 2), 0, d)
    below = h * h * (1.5 * d - h) * 2 / d ** 3    # pi h^2 (3R - h)/3 over the volume of the sphere
    return np.diff(below, axis=1)


def column_kernel(cells, edge, bandwidth, bandwidth_cells=1.5):
    """[cells][cells] smoothing of the exchange (doc/equations.md C.16) in a column of cubes that has the same in every cell of a
    section; bandwidth in m. What is given to cell k comes out as row k; nothing leaves at the ends."""
    variance = max(bandwidth, bandwidth_cells * edge) ** 2 / 2 / edge ** 2
    passes = int(np.ceil(round(6 * variance / 2 / 0.7, 12)))
    once = np.eye(cells)
    for k in range(cells - 1):
        once[k:k + 2, k:k + 2] += variance / (2 * passes) * np.array([[-1, 1], [1, -1]])
    return np.linalg.matrix_power(once, passes)


class Block:
    """Layers of spheres across a column of cells.

    z: heights of the layers; per_cell: spheres of a layer in one cell of a section; area: of that cell;
    kernel: of the smoothing (column_kernel), with which the weights of the exchange are those of the caps times it."""

    def __init__(self, z, d, per_cell, area, faces, kernel=None, rho=1000.0, mu=1e-3):
        self.d, self.n, self.area = d, per_cell, area
        self.rho, self.mu = rho, mu
        self.height = np.diff(faces)
        self.weights = cap_weights(z, d, faces)
        if kernel is not None:
            self.weights = self.weights @ kernel
        self.eps = 1 - per_cell * sphere(d) * self.weights.sum(0) / (area * self.height)
        self.eps_layer = self.weights @ self.eps           # what a sphere of each layer sees

    def force_over_eps(self, w):
        """Sum over layers and cells of w_ic F(w, eps_i)/eps_c, N per cell of a section: drag and the force of
        the pressure gradient that drag makes (model A); in model B the drag itself is that."""
        return self.n * (self.weights / self.eps).sum(1) @ di_felice(w, self.d, self.eps_layer, self.rho, self.mu)

    def drag_per_height(self, w):
        """Drag in each cell over mixture volume, N/m3."""
        return self.n * di_felice(w, self.d, self.eps_layer, self.rho, self.mu) @ self.weights / (self.area * self.height)


def flow_speed(block, length, rho=1000.0):
    """Superficial speed of the flow that gravity drives through the fixed block in a periodic column.

    The superficial velocity is uniform, and the pressure jumps where the porosity does cancel over the period:
    sum over cells of force/eps = rho g length area."""
    return root(lambda w: block.force_over_eps(w) - rho * G * length * block.area, 1e-6, 1e2)


def flow_pressure(block, speed, rho=1000.0):
    """Pressure (Pa, periodic, zero mean over the cells) at the centres, and points (z, p) of its piecewise linear
    course, for flow downwards. In a cell dp/dz = drag/eps - rho g; at a step of porosity p + rho u^2/2 is
    continuous (no loss: that is what the averaged equations say of a sharp step)."""
    slope = block.drag_per_height(speed) / block.eps - rho * G
    head = rho * speed ** 2 / 2 / block.eps ** 2
    z, p, at, centre = [], [], 0.0, []
    faces = np.concatenate([[0], np.cumsum(block.height)])
    for c, s in enumerate(slope):
        if c:
            at -= head[c] - head[c - 1]
        z += [faces[c], faces[c + 1]]
        p += [at, at + s * block.height[c]]
        centre.append(at + s * block.height[c] / 2)
        at = p[-1]
    mean = np.mean(centre)
    return np.array(centre) - mean, np.array(z), np.array(p) - mean


class Settling:
    """A rigid block that sinks in a closed column it spans: no net flux, so the superficial slip is its speed."""

    def __init__(self, layers, d, per_cell, area, faces, rho_s, rho=1000.0, kernel=None, mu=1e-3):
        """layers: heights over the lowest point of the block; the block's position is that of this point."""
        self.layers, self.d, self.n, self.area, self.faces = np.asarray(layers), d, per_cell, area, faces
        self.kernel = kernel
        self.rho_s, self.rho, self.mu = rho_s, rho, mu
        self.weight = per_cell * len(layers) * sphere(d) * (rho_s - rho) * G

    def block(self, position):
        return Block(self.layers + position, self.d, self.n, self.area, self.faces, self.kernel, self.rho, self.mu)

    def quasi_steady(self, position, share=1.0):
        """Speed at which force/eps equals share of the buoyant weight."""
        block = self.block(position)
        return root(lambda w: block.force_over_eps(w) - share * self.weight, 1e-9, 1e2)

    def moving_mass(self, block):
        """Spheres, and the fluid they have to accelerate: pushing all fluid of the block up through it adds
        rho (1 - eps)^2/eps per volume (from the momentum of the averaged equations for j = 0)."""
        added = self.rho * ((1 - block.eps) ** 2 / block.eps * block.height).sum() * self.area
        return self.n * len(self.layers) * sphere(self.d) * self.rho_s + added

    def fall(self, start, ramp, dt=1e-3, end=20.0):
        """(t, position, speed) from rest to the floor, with inertia and the gravity ramp of Markauskas et al.,
        eq. 3-4. Heun's method; the drag is quadratic in the speed, so that starts well."""
        def acceleration(t, z, v):
            block = self.block(z)
            xi = 0.5 * (1 - np.cos(np.pi * t / ramp)) if t < ramp else 1.0
            drag = block.force_over_eps(v) if v > 0 else 0.0
            return (xi * self.weight - drag) / self.moving_mass(block)
        rows = [(0.0, start, 0.0)]
        while rows[-1][1] > 0 and rows[-1][0] < end:
            t, z, v = rows[-1]
            a = acceleration(t, z, v)
            b = acceleration(t + dt, z - dt * v, max(v + dt * a, 0))
            vn = v + dt * (a + b) / 2
            rows.append((t + dt, z - dt * (v + vn) / 2, vn))
        return np.array(rows).T


def time_between(t, position, upper, lower):
    """Time a falling body takes from one height to another, from samples (interpolated)."""
    order = np.argsort(position)
    at = np.interp([upper, lower], position[order], t[order])
    return at[1] - at[0]


def sphere_terminal(d, rho_s, eps, rho=1000.0):
    """Slip speed u - v of one sphere where drag equals buoyant weight (Markauskas eq. 27; fluid at rest)."""
    weight = (rho_s - rho) * sphere(d) * G
    return root(lambda w: di_felice(w, d, eps) - weight, 1e-9, 1e2) / eps
