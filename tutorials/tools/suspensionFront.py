# SPDX-License-Identifier: GPL-3.0-or-later
"""Growth rate of a disturbance of the front between a suspension and the clear fluid below it. SI units, needs numpy.

Linear stability of the averaged equations that the solvers solve (M.1, S.1, P.7 of doc/equations.md), with the fluid's viscosity, no viscosity of
the suspension. With w(z) exp(n t + i k x) the vertical part of j, the flux of the mixture, in the frame of the particles at rest:

  n A w + M w' - (n A w' + M w'')'/k^2 - viscous = -g rho',      A = (eps rho + X phi rho_p) C,    C = 1/(eps + X phi)

phi(z) solids, eps = 1 - phi; M = rho V the flux of fluid that passes the front, which sinks with V; X the ratio of the velocities of particles and
fluid, which lags behind 1 by the time drag needs; viscous: of div(eps mu grad u), u being C j. Particles carry their place: at each
step of the profile by d phi the density changes by g (rho_p - rho) d phi X C w/n, and all that goes through the kernel of the exchange: a Gaussian, once
when solids and forces are given to the fluid and once when the fluid is sampled. A narrow kernel and one step: two fluids, as Chandrasekhar's
(1961, sec. 94), and his rate where V and the lag are 0 and both fluids have one viscosity."""
import math

import numpy as np

G = 9.81


def _normal(z, variance):
    return 0.5 * (1 + np.array([math.erf(x / math.sqrt(2 * variance)) for x in np.ravel(z)]).reshape(np.shape(z)))


class Front:
    """rho, mu: fluid; solid: density of the particles; speed: of their settling; beta: drag per slip of interstitial velocities and mixture volume in
    the suspension; depth: of both layers (their far ends slip); variance: of the kernel; steps: [(z, d phi)] of the profile, z = 0 at the front; buoyant: the form
    of the force, with the pressure gradient of the flow (model A) or that of drag and weight only (combined, P.7)."""

    def __init__(self, rho, mu, solid, speed, beta, depth, variance, steps, buoyant=True, cells=240):
        self.rho, self.solid, self.beta, self.buoyant = rho, solid, beta, buoyant
        self.steps, self.variance, self.flux, self.mu = np.array(steps, float), variance, rho * speed, mu
        self.phi = self.steps[:, 1].sum()
        z = np.linspace(-depth, depth, cells + 1)
        self.z, self.dz = z[1:-1], z[1] - z[0]
        self.faces = 0.5 * (z[1:] + z[:-1])
        inner = cells - 1
        self.grad, self.mean = np.zeros((cells, inner)), np.zeros((cells, inner))
        for i in range(inner):
            self.grad[i, i], self.grad[i + 1, i] = 1 / self.dz, -1 / self.dz
            self.mean[i, i] = self.mean[i + 1, i] = 0.5

    def solids(self, z):
        return sum(d * _normal(z - at, self.variance) for at, d in self.steps)

    def matrices(self, k):
        """What does not depend on n: viscous on nodes and on faces, derivative of the values at faces."""
        mu_n, mu_f = (self.mu * (1 - self.solids(z)) for z in (self.z, self.faces))
        on_nodes = -self.grad.T @ (mu_f[:, None] * self.grad) - np.diag(k * k * mu_n)
        on_faces, along, cells = np.zeros(2 * self.faces.shape), np.zeros(2 * self.faces.shape), len(self.faces)
        for i in range(1, cells):
            c = mu_n[i - 1] / self.dz ** 2
            on_faces[i - 1:i + 1, i - 1:i + 1] += c * np.array([[-1, 1], [1, -1]])
        for i in range(cells):
            a, b = max(i - 1, 0), min(i + 1, cells - 1)
            along[i, b] += 1 / ((b - a) * self.dz)
            along[i, a] -= 1 / ((b - a) * self.dz)
        return on_nodes, on_faces - np.diag(k * k * mu_f), along

    def gain(self, n, k, matrices):
        """Rate at which the profile, disturbed and growing with n, would disturb itself: largest eigenvalue; n is a growth rate where it is n."""
        on_nodes, on_faces, along = matrices
        phi, eps = self.phi, 1 - self.phi
        drag = self.beta
        if self.buoyant:
            lag = (drag + phi * (eps * self.rho + phi * self.solid) * n) / (drag + phi * self.solid * n)
        else:
            lag = 1 / (1 + phi * self.solid * n * eps / drag)

        def carried(z):
            p = self.solids(z)
            return (self.rho * (1 - p) + lag * self.solid * p) / (1 - p + lag * p)
        inertia = np.diag(n * carried(self.faces)) + self.flux * along - on_faces
        left = np.diag(n * carried(self.z)) - self.flux * self.grad.T @ self.mean - on_nodes + self.grad.T @ inertia @ self.grad / k ** 2
        kernel = np.exp(-(self.z[:, None] - self.steps[:, 0]) ** 2 / (2 * self.variance) - k * k * self.variance / 2) / math.sqrt(2 * math.pi * self.variance)
        answer = kernel.T @ np.linalg.solve(left, kernel) * self.dz
        d = G * (self.solid - self.rho) * lag / (eps + lag * phi) * self.steps[:, 1]
        return np.linalg.eigvals(answer * d).real.max()

    def rate(self, k):
        """Growth rate (1/s) at the wave number k (1/m)."""
        matrices, low, high = self.matrices(k), 1.0, 300.0
        for _ in range(24):
            n = math.sqrt(low * high)
            low, high = (n, high) if self.gain(n, k, matrices) > n else (low, n)
        return n


def chandrasekhar(k, rho, mu, rho_d, mu_d):
    """Growth rate (1/s) of two fluids, the heavier (rho_d, mu_d) above (Chandrasekhar 1961; Robinson et al. 2014, eq. 38)."""
    af, ad = rho / (rho + rho_d), rho_d / (rho + rho_d)
    nf, nd = mu / rho, mu_d / rho_d

    def relation(n):
        qf, qd = math.sqrt(k * k + n / nf), math.sqrt(k * k + n / nd)
        return ((G * k / n ** 2 * (af - ad) + 1) * (ad * qf + af * qd - k) + 4 * k * af * ad
                - 4 * k * k / n * (af * nf - ad * nd) * (ad * qf - af * qd + k * (af - ad))
                - 4 * k ** 3 / n ** 2 * (af * nf - ad * nd) ** 2 * (qf - k) * (qd - k))
    low, high = 1e-3, 1e3
    for _ in range(100):
        n = math.sqrt(low * high)
        low, high = (n, high) if relation(n) < 0 else (low, n)
    return n
