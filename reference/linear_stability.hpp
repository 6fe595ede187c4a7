#pragma once

#include <vector>

/// How large a time step a linear scene bears: closed forms, as the Courant number C = c dt / h of the wave
/// speed c, the time step and the cell size.
///
/// All of them are of one step of the Material Point Method about a state at rest and free of stress, without
/// damping and with particles that take the acceleration of the grid (pure FLIP), places held. Lengths are in
/// cells, times in h / c and stresses in density * c^2, so that C is the time step.
///
/// In terms of the nodes. Let v be the velocities that the particles make at the nodes, g the nodal
/// accelerations that their stresses make, S the weights, B the weight gradients. With the nodal mass M = sum
/// S m, the stiffness K = sum B^T m B (per M, in the coordinates that make it symmetric) and T = M^-1 sum S^T
/// m S, which has its eigenvalues between 0 and 1 because a mean never has more energy than what it is the
/// mean of,
///
///     v' = v - C T g      g' = g + C K (v - C g)   (USL)      g' = g + C K v'   (MUSL, USF).
///
/// With k = g* K^-1 g and t = g* T g of an eigenvector g of length 1, and kappa = 1 / k <= the largest
/// eigenvalue of K, its eigenvalue 1 + mu is a root of mu^2 + kappa C^2 (mu + t) = 0 (USL) or mu^2 + kappa t
/// C^2 (mu + 1) = 0 (MUSL, USF), and within the unit circle exactly if
///
///     kappa C^2 (2 - t) <= 4   (USL),      kappa t C^2 <= 4   (MUSL, USF).
///
/// What is left is to know kappa and t. MUSL and USF are the same operator in another order.
namespace mpm::reference {

/// Whose velocities strain the particles.
enum class StrainedBy {
  grid,       ///< the accelerated grid's: USL
  particles,  ///< those that the particles make at the nodes: MUSL and USF
};

/// A particle of a bar that repeats itself from cell to cell.
struct BarParticle {
  double offset;           ///< past the node below [cells], in [0, 1)
  double half_size = 0.0;  ///< [cells], at most 1; 0 is a point
};

/// The largest sum over nodes i of |B_i|^2 / S_i of a particle, in squares of wave speeds per cell: the
/// stiffness of a particle alone with the nodes it reaches. A point: 1 / (s (1 - s)) at the offset s. A
/// domain of half size l within a cell the same; one that reaches over a node by no more than a cell on
/// either side, its center d from it: 2 / l + d^2 / (l^2 S), S = 1 - (l^2 + d^2) / (2 l): each outer node
/// takes 1 / l however little mass it has, which is why domains have no small steps. For half sizes up to 1/2
/// cell; throws std::invalid_argument beyond, for an offset outside [0, 1) and for a point on a node.
double lone_stiffness(const BarParticle& particle);

/// A particle alone with free nodes that are strained by the accelerated grid: nothing couples its stress to
/// its velocity (the forces have no sum, so t = 0 in what moves it), and a step makes 1 - C^2
/// `lone_stiffness` of its stress. Stable up to sqrt(2 / lone_stiffness): of a point sqrt(2 s (1 - s)).
/// Strained by the particles it is neutral at any step.
///
/// The same of the worst particle is safe for any bar under USL, whatever else is in it: M and K are sums
/// over the particles, so no kappa exceeds the largest `lone_stiffness`, and kappa C^2 (2 - t) <= 2 kappa
/// C^2.
double lone_particle_limit(const BarParticle& particle);

/// A point alone in a square cell, plane strain, at offsets along both axes, under USL. As shape functions
/// are products whose gradients have no sum, the cross terms of sum B_a B_b / S vanish and the normal
/// stresses are made 1 - C^2 [[X, r Y], [r X, Y]] of, r = nu / (1 - nu), the shear stress 1 - C^2 (X + Y)(1 -
/// 2 nu) / (2 (1 - nu)), with X = 1 / (s_x (1 - s_x)), Y alike; c is the speed of compression waves. Both
/// offsets alike: 2 s (1 - s)(1 - nu) = C^2.
double lone_particle_limit(double offset_x, double offset_y, double poissons_ratio);

/// A bar without ends that has these particles, of equal size, in every cell. Of a wave exp(i n theta) over
/// the nodes n both sums are numbers: kappa = mean |B|^2, t = mean |S|^2 over the particles, B and S the
/// symbols of their gradients and weights. Of points, x = sin^2(theta / 2): |B|^2 = 4 x, |S|^2 = 1 - 4 s (1 -
/// s) x; with q the mean of 4 s (1 - s)
///
///     x C^2 (1 + q x) <= 1  for x up to 1:   C = 1 / sqrt(1 + q)    (grid)
///     x C^2 (1 - q x) <= 1:   C = 2 sqrt(q) where q >= 1/2, else 1 / sqrt(1 - q)    (particles).
///
/// For domains the largest over the waves is searched for, to 1e-9. Of domains that lie within a cell each,
/// both sums are those of points. Throws std::invalid_argument without particles or for one out of range.
double endless_bar_limit(const std::vector<BarParticle>& particles, StrainedBy strained_by);

/// A free end of a bar of points under USL, n per cell evenly spaced, the last of them by `offset` past the
/// outermost node it has in common with others: to first order in the offset,
///
///     C = sqrt(2 s / (1 + s (mu - Q / 2))),   mu = 2 / (n + 1),   Q = (3 n - 2)(n - 1) / (3 n (n + 1)).
///
/// The end node has the mass s of the last particle and takes all the force of its stress, the node before
/// the mass M = (n + 1)/2: a step makes 1 - C^2 (1/s + mu) of the stress through these two. Through the
/// velocities, to which the stress gives C (S_q mu - [q is the last]) and which give the stress the negative
/// of that, S_q = 1 - k/n, it comes back as -C^2 Q / (lambda - 1), Q = sum of (S_q mu - [q is last])^2, which
/// at the limit lambda = -1 is C^2 Q / 2. All else is of higher order. An offset above 1/2 is out of its
/// range: throws std::invalid_argument.
double free_end_limit(int particles_per_cell, double offset);

}  // namespace mpm::reference
