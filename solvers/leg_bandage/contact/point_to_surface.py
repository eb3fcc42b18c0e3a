"""Contact of points of the bandage with a smooth surface: residual and full tangent.

A point x = sum_a R_a x_a of the bandage is projected onto y(xi). With d = x - y and
n the surface normal, g = d . n - offset is the gap. The traction on the bandage is
F = p n + t; virtual work A F . (dx - dy). Linearised with the motion of the projection,
the curvature of the surface and the turning of the normal (Wriggers 2006, ch. 4 and 5;
Konyukhov and Schweizerhof 2013 for the covariant form) ::

    (a - d . y_ab) dxi = y_a . (dx - dy) + d . dy_a          a = metric

so that everything is a 9 x 9 matrix on (dx - dy, dy_1, dy_2) at each point. Slip is
measured from an anchor in the surface's own convected coordinates.

Newton on t = -mu p s / N(|s|) alone overshoots for ever once |s| exceeds the elastic slip,
as it does on any saturating function. So the direction w, |w| <= 1, is an unknown of its
own, with w N(|s|) = s, linearised in both and condensed point by point (Chan, Golub and
Mulet 1999, for total variation): the residual stays that of the law, and the tangent
takes w for s / N, which agrees at the solution.

Areas are those of the laid bandage: pressures are per laid area (see `pressure_map` for the
true ones).
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace

import numpy as np

from ..algebra.system import Tangent
from ..surfaces.projection import metric, project, solve2
from .law import ContactLaw
from .sparsity import ContactPattern


@dataclass(frozen=True)
class Points:
    """Points of the bandage that may touch: nodes (n, k), weights (n, k), area (n,) mm2.

    `tied` (n,) marks the points that always stick and never open. `laid` (n,) are their numbers
    among all laid points of the bandage; several may have the same.
    """

    nodes: np.ndarray
    weights: np.ndarray
    area: np.ndarray
    tied: np.ndarray
    laid: np.ndarray = field(default_factory=lambda: np.zeros(0, int))

    def some(self, which) -> Points:
        """Some of the points."""
        return Points(*(getattr(self, one.name)[which] for one in fields(self)))

    def at(self, x):
        """Positions (n, 3) for nodal positions x (nodes, 3)."""
        return np.einsum("pk,pkc->pc", self.weights, x[self.nodes])


@dataclass(frozen=True)
class ContactState:
    """Projection and anchor in surface parameters (n, 2), direction of friction (n, 3), bonded."""

    xi: np.ndarray
    anchor: np.ndarray
    w: np.ndarray
    bonded: bool = True


class Contact:
    """Points against one surface, as a mechanical part with a fixed pattern.

    X (nodes, 3) are the positions at zero displacement (kept by reference); `offset`
    (n,) is the distance at which the gap is zero.
    """

    def __init__(self, points: Points, surface, X, xi, offset, law: ContactLaw):
        self.points, self.surface, self.X, self.law = points, surface, X, law
        self.offset = np.asarray(offset, float)
        self.current = ContactState(xi.copy(), xi.copy(), np.zeros((len(xi), 3)))
        self.rebuild()

    # -- the Part protocol -------------------------------------------------------------

    def state(self):
        """What `restore` takes back."""
        return self.current, self.points, self.offset

    def restore(self, state):
        """Take back points, projection, anchors and mode of an earlier state."""
        changed = state[1] is not self.points
        self.current, self.points, self.offset = state
        if changed:
            self.rebuild()

    def advance(self, du, step=1.0):
        """Move the directions w along the Newton increment `du` of the last tangent.

        `step` is the damping.
        """
        ds, s, unit, psi, bend, nodes, weights = self._last
        moved = np.einsum("pkm,pmc->pkc", weights, du.reshape(-1, 3)[nodes])
        change = np.einsum("pcj,pj->pc", ds, moved.reshape(len(moved), 9))
        w = self.current.w
        along = np.einsum("pc,pc->p", unit, change)
        # N = 1 / psi, so N' = -psi' / psi^2
        target = psi[:, None] * (s + change) + (bend / psi * along)[:, None] * w
        w = w + step * (target - w)
        w /= np.maximum(np.linalg.norm(w, axis=1), 1.0)[:, None]
        self.current = replace(self.current, w=w)

    def linearise(self, u) -> tuple[np.ndarray, Tangent]:
        """Residual (ndof,) and tangent, values (nnz,), at displacements u (ndof,)."""
        x = self.X + u.reshape(-1, 3)
        k = self._kinematics(x)
        nodes, weights = self._operators(k)
        force, grip = self._traction(k)

        def tangent():
            D, ds = self._tangent(k, force, grip)
            psi, bend = self.law.friction_factor(k["slip_size"])
            unit = k["slip"] / np.maximum(k["slip_size"], 1e-30)[:, None]
            self._last = ds, k["slip"], unit, psi, bend, nodes, weights
            return self.pattern.assemble(k["xi"], weights, D)

        residual = np.zeros(u.size)
        for c in range(3):
            share = -weights[:, 0] * (force[:, c] * self.points.area)[:, None]
            residual[c::3] = np.bincount(nodes.ravel(), share.ravel(), minlength=u.size // 3)
        return residual, tangent

    # -- load steps --------------------------------------------------------------------

    def bond(self):
        """Make every point bilateral and sticking."""
        self.current = replace(self.current, bonded=True)

    def slide(self, u):
        """Let Coulomb's law act from the bonded state u on, with the friction it can give.

        The anchors move so that each point keeps its bonded traction, or as much of it as
        mu p allows: phi(y) = min(|t| / (mu p), 1).
        """
        k = self._kinematics(self.X + u.reshape(-1, 3))
        most = self.law.mu * np.maximum(k["p"], 0.0)
        grip = self.law.penalty * k["slip_size"]
        share = np.where(grip < most, grip / np.maximum(most, 1e-300), 1.0)
        slip = self.law.elastic_slip * (1 - np.sqrt(1 - share))
        scale = np.where(most > 0, slip / np.maximum(k["slip_size"], 1e-300), 0.0)
        scale = np.where(self.points.tied, 1.0, scale)
        self.current = replace(self._anchored(k, scale), bonded=False)

    def accept(self, u):
        """End of a load step: slip beyond the elastic slip moves the anchors.

        Returns the energy dissipated in this step, N mm; it is never negative.
        """
        k = self._kinematics(self.X + u.reshape(-1, 3))
        stuck = self._bonded(self.current.bonded)
        keep = np.where(stuck, 1.0, self.law.kept(k["slip_size"]))
        keep = np.where((k["p"] > 0) | stuck, keep, 0.0)
        lost = self.law.mu * k["p"] * k["slip_size"] * (1 - keep) * self.points.area
        self.current = self._anchored(k, keep)
        return float(lost[~stuck].sum())

    def report(self, u):
        """Gap, pressure per laid area, traction (n, 3), slip, normal and parameters now."""
        k = self._kinematics(self.X + u.reshape(-1, 3))
        force, _ = self._traction(k)
        names = ("gap", "p", "slip_size", "normal", "xi")
        return {name: k[name] for name in names} | {"traction": force}

    # -- mechanics ---------------------------------------------------------------------

    def _bonded(self, bonded):
        return self.points.tied | bonded

    def _anchored(self, k, share):
        """The state of kinematics k after anchors moved so that a share (n,) of slip is left.

        Its directions are w = s / N(|s|): the tangent is then the residual's derivative.
        """
        psi, _ = self.law.friction_factor(share * k["slip_size"])
        w = (psi * share)[:, None] * k["slip"]
        anchor = k["xi"] - share[:, None] * k["shift"]
        return replace(self.current, xi=k["xi"], anchor=anchor, w=w)

    def _kinematics(self, x):
        points = self.points.at(x)
        xi = project(self.surface, points, x, self.current.xi)
        jet = self.surface.at(xi, x)
        d = points - jet[:, 0]
        normal = self._normal(jet)
        gap = np.einsum("pc,pc->p", d, normal) - self.offset
        bonded = self._bonded(self.current.bonded)
        p, slope = self.law.pressure(gap, bonded)
        shift = xi - self.current.anchor
        slip = np.einsum("pac,pa->pc", jet[:, 1:3], shift)
        return {
            "xi": xi, "jet": jet, "d": d, "normal": normal, "gap": gap, "bonded": bonded,
            "p": p, "slope": slope, "shift": shift, "slip": slip,
            "slip_size": np.linalg.norm(slip, axis=1),
        }  # fmt: skip

    def _normal(self, jet):
        """Outward unit normals (n, 3) of the surface."""
        normal = np.cross(jet[:, 1], jet[:, 2])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        return -normal if self.surface.flip else normal

    def _traction(self, k):
        """Traction F = p n - grip s (n, 3) on the bandage, and grip (n,), MPa/mm."""
        psi, _ = self.law.friction_factor(k["slip_size"])
        grip = np.where(k["bonded"], self.law.penalty, self.law.mu * k["p"] * psi)
        return k["p"][:, None] * k["normal"] - grip[:, None] * k["slip"], grip

    def _tangent(self, k, force, grip):
        """The 9 x 9 tangent of the virtual work of F, (n, 9, 9), and dslip (n, 3, 9)."""
        jet, n, d, p, s = k["jet"], k["normal"], k["d"], k["p"], k["slip"]
        bonded, size, count = k["bonded"], k["slip_size"], len(n)
        # rows of dxi: (n, 2, 9) on (dx - dy, dy_1, dy_2)
        rhs = np.zeros((count, 2, 9))
        rhs[:, :, :3] = jet[:, 1:3]
        rhs[:, 0, 3:6] = rhs[:, 1, 6:9] = d
        dxi = solve2(metric(jet, d), rhs)
        # total change of both tangent vectors: (n, 2, 3, 9)
        dy = np.zeros((count, 2, 3, 9))
        for a, (one, two) in enumerate(((3, 5), (5, 4))):
            dy[:, a] = np.einsum("pc,pj->pcj", jet[:, one], dxi[:, 0])
            dy[:, a] += np.einsum("pc,pj->pcj", jet[:, two], dxi[:, 1])
            dy[:, a, [0, 1, 2], [3 + 3 * a, 4 + 3 * a, 5 + 3 * a]] += 1.0
        first = np.einsum("pac,pbc->pab", jet[:, 1:3], jet[:, 1:3])
        dual = solve2(first, jet[:, 1:3])
        dn = -np.einsum("pac,pe,paej->pcj", dual, n, dy, optimize=True)
        dp = np.zeros((count, 9))
        dp[:, :3] = k["slope"][:, None] * n
        ds = np.einsum("pa,pacj->pcj", k["shift"], dy)
        ds += np.einsum("pac,paj->pcj", jet[:, 1:3], dxi)

        psi, bend = self.law.friction_factor(size)
        loosen = np.where(bonded, 0.0, self.law.mu * p * bend / psi / np.maximum(size, 1e-30))
        w = np.where(bonded[:, None], 0.0, self.current.w)
        dF = np.einsum("pc,pj->pcj", n - self.law.mu * w, dp)
        dF += p[:, None, None] * dn - grip[:, None, None] * ds
        along = np.einsum("pc,pcj->pj", s, ds)
        dF -= np.einsum("p,pc,pj->pcj", loosen, w, along)

        tangent = np.zeros((count, 9, 9))
        tangent[:, :3] = -dF
        tangent[:, 3:6] = np.einsum("pc,pj->pcj", force, dxi[:, 0])
        tangent[:, 6:9] = np.einsum("pc,pj->pcj", force, dxi[:, 1])
        return tangent * self.points.area[:, None, None], ds

    def _operators(self, k):
        """Nodes (n, m) and weights (n, 3, m) of dx - dy, dy_1, dy_2."""
        own = self.points
        nodes, jet = self.surface.stencil(k["xi"])
        weights = np.zeros((len(nodes), 3, own.nodes.shape[1] + nodes.shape[1]))
        m = own.nodes.shape[1]
        weights[:, 0, :m] = own.weights
        weights[:, :, m:] = jet[:3].transpose(1, 0, 2)
        weights[:, 0, m:] *= -1.0
        return np.hstack([own.nodes, nodes]), weights

    # -- pattern -----------------------------------------------------------------------

    def close(self, u=0.0):
        """Set the offsets so that all gaps are zero at displacements u, and anchor there."""
        k = self._kinematics(self.X + np.reshape(np.broadcast_to(u, self.X.size), self.X.shape))
        self.offset = self.offset + k["gap"]
        self.current = replace(self.current, xi=k["xi"], anchor=k["xi"].copy())
        self.rebuild()

    def take_over(self, old: Contact, n: int):
        """Give the first n points the offsets, projections and anchors that they had in `old`."""
        self.offset[:n] = old.offset[:n]
        for mine, theirs in zip(
            (self.current.xi, self.current.anchor, self.current.w),
            (old.current.xi, old.current.anchor, old.current.w),
            strict=True,
        ):
            mine[:n] = theirs[:n]
        self.rebuild()

    def drop(self, gone):
        """Face these points (n,) no longer."""
        kept, now = ~gone, self.current
        self.points, self.offset = self.points.some(kept), self.offset[kept]
        self.current = replace(now, xi=now.xi[kept], anchor=now.anchor[kept], w=now.w[kept])
        self.rebuild()

    def take(self, points: Points, xi, height: float, x):
        """Face more points, at parameters xi (n, 2), without pressure or slip.

        height at which their gap is zero, or less where they are lower now; x (nodes, 3) positions
        """
        if not len(xi):
            return
        jet, old = self.surface.at(xi, x), self.points
        away = np.einsum("pc,pc->p", points.at(x) - jet[:, 0], self._normal(jet))
        offset = np.minimum(height, away - self.law.ramp)
        self.points = Points(*(
            np.concatenate([getattr(old, one.name), getattr(points, one.name)])
            for one in fields(old)
        ))  # fmt: skip
        self.offset = np.concatenate([self.offset, offset])
        now = self.current
        self.current = replace(
            now,
            xi=np.concatenate([now.xi, xi]),
            anchor=np.concatenate([now.anchor, xi]),
            w=np.concatenate([now.w, np.zeros((len(xi), 3))]),
        )
        self.rebuild()

    def follow(self, u):
        """Take the projections at displacements u and lay the pattern out round them."""
        x = self.X + u.reshape(-1, 3)
        xi = project(self.surface, self.points.at(x), x, self.current.xi)
        self.current = replace(self.current, xi=xi)
        self.rebuild()

    def rebuild(self):
        """Lay out the pattern around the present projections; rows and cols change."""
        self.pattern = ContactPattern(self.points.nodes, self.surface, self.current.xi)
        self.rows, self.cols = self.pattern.rows, self.pattern.cols
