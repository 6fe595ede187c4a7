#pragma once

#include <array>
#include <optional>

#include "reference/element_paths.hpp"

namespace mpm::reference {

/// Where on the limit a stress comes to lie.
enum class LimitPart { inside, face, compression_edge, extension_edge, apex };

/// A stress on or inside the limit, along the axes of the trial it was returned from.
struct ReturnedStress {
  std::array<double, 3> principal;  ///< [Pa], tension positive
  LimitPart part;
};

/// The Mohr–Coulomb return of three principal stresses [Pa] along fixed axes, in any order, by the equations
/// of several yield surfaces at once [Koiter53]:
///
///     s = trial - D sum_i flow_i dg_i/ds,   flow_i >= 0,   f_i(s) <= 0,   flow_i f_i(s) = 0
///
/// over the six faces f_ab = s_a (1 + sin phi) - s_b (1 - sin phi) - 2 c cos phi, g_ab the same of psi, and,
/// to let the apex take an expansion that flow without dilation has not, the mean stress that the apex has.
/// Every set of one to three surfaces is tried in turn and the first that keeps the inequalities is taken.
/// With psi = phi they are the conditions for the closest admissible stress in the norm of elastic energy.
/// Plain and slow; it knows no order of the principal stresses and no region. Nothing where no set does,
/// which would contradict the existence of a return. Good to about 1e-12 of the trial stress for phi >= 5
/// degrees. Throws std::invalid_argument for an impossible soil.
std::optional<ReturnedStress> multi_surface_return(const MohrCoulombSoil& soil,
                                                   const std::array<double, 3>& trial);

}  // namespace mpm::reference
