#include "reference/linear_stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace mpm::reference {
namespace {

using Symbol = std::complex<double>;

void require(bool condition, const char* what) {
  if (!condition) throw std::invalid_argument(what);
}

void require_particle(const BarParticle& particle) {
  require(particle.offset >= 0 && particle.offset < 1, "the offset of a particle is not within its cell");
  require(particle.half_size >= 0 && particle.half_size <= 1,
          "the half size of a particle is not within a cell");
}

/// The interpolation of exp(i n theta) between the nodes n, at a place.
Symbol hat_at(double place, double theta) {
  const double node = std::floor(place), past = place - node;
  return std::polar(1.0, node * theta) * (1 - past + past * std::polar(1.0, theta));
}

/// Its integral from 0 to a place.
Symbol integral_to(double place, double theta) {
  const double node = std::floor(place), past = place - node;
  const auto over_part = [&](double n, double part) {
    return std::polar(1.0, n * theta) * (part - part * part / 2 + part * part / 2 * std::polar(1.0, theta));
  };
  Symbol sum = over_part(node, past);
  for (double n = 0; n < node; ++n) sum += over_part(n, 1.0);
  for (double n = node; n < 0; ++n) sum -= over_part(n, 1.0);
  return sum;
}

/// Mean |B|^2 and mean |S|^2 over the particles of a cell.
struct WaveSums {
  double stiffness = 0.0, projection = 0.0;
};

WaveSums sums_at(const std::vector<BarParticle>& particles, double theta) {
  WaveSums sums;
  for (const auto& [offset, half_size] : particles) {
    if (half_size > 0.0) {
      const double low = offset - half_size, high = offset + half_size;
      sums.stiffness += std::norm(hat_at(high, theta) - hat_at(low, theta)) / std::pow(2 * half_size, 2);
      sums.projection +=
          std::norm(integral_to(high, theta) - integral_to(low, theta)) / std::pow(2 * half_size, 2);
    } else {
      sums.stiffness += 4 * std::pow(std::sin(theta / 2), 2);
      sums.projection += std::norm(hat_at(offset, theta));
    }
  }
  const auto count = static_cast<double>(particles.size());
  return {sums.stiffness / count, sums.projection / count};
}

/// What 4 / C^2 is at least, of one wave.
double demand_of(const WaveSums& sums, StrainedBy strained_by) {
  return sums.stiffness * (strained_by == StrainedBy::grid ? 2 - sums.projection : sums.projection);
}

double largest_demand(const std::vector<BarParticle>& particles, StrainedBy strained_by) {
  const auto demand = [&](double theta) { return demand_of(sums_at(particles, theta), strained_by); };
  constexpr int samples = 720;
  constexpr double spacing = std::numbers::pi / samples;
  double worst = 0.0;
  for (int k = 1; k <= samples; ++k)
    if (demand(k * spacing) > demand(worst)) worst = k * spacing;
  double low = worst - spacing, high = worst + spacing;
  while (high - low > 1e-9) {
    const double first = low + (high - low) / 3, second = high - (high - low) / 3;
    if (demand(first) < demand(second)) {
      low = first;
    } else {
      high = second;
    }
  }
  return demand((low + high) / 2);
}

double endless_bar_of_points(double q, StrainedBy strained_by) {
  if (strained_by == StrainedBy::grid) return 1 / std::sqrt(1 + q);
  return q >= 0.5 ? 2 * std::sqrt(q) : 1 / std::sqrt(1 - q);
}

}  // namespace

double lone_stiffness(const BarParticle& particle) {
  require_particle(particle);
  const auto& [s, l] = particle;
  if (l == 0.0) {
    require(s > 0.0, "a point on a node has no other node");
    return 1 / (s * (1 - s));
  }
  require(l <= 0.5, "the domain of a particle alone is larger than a cell");
  if (s >= l && s + l <= 1) return 1 / (s * (1 - s));
  const double d = std::min(s, 1 - s);
  return 2 / l + d * d / (l * l * (1 - (l * l + d * d) / (2 * l)));
}

double lone_particle_limit(const BarParticle& particle) { return std::sqrt(2 / lone_stiffness(particle)); }

double lone_particle_limit(double offset_x, double offset_y, double poissons_ratio) {
  const double x = lone_stiffness({offset_x}), y = lone_stiffness({offset_y});
  const double r = poissons_ratio / (1 - poissons_ratio);
  // The shear stress, (x + y)(1 - r) / 2, is never worse.
  return std::sqrt(2 / ((x + y) / 2 + std::sqrt(std::pow((x - y) / 2, 2) + r * r * x * y)));
}

double endless_bar_limit(const std::vector<BarParticle>& particles, StrainedBy strained_by) {
  require(!particles.empty(), "a bar has particles");
  for (const BarParticle& particle : particles) require_particle(particle);
  const bool of_points = std::all_of(particles.begin(), particles.end(),
                                     [](const BarParticle& particle) { return particle.half_size == 0.0; });
  if (!of_points) return 2 / std::sqrt(largest_demand(particles, strained_by));
  const double q =
      std::accumulate(particles.begin(), particles.end(), 0.0,
                      [](double sum, const BarParticle& p) { return sum + 4 * p.offset * (1 - p.offset); });
  return endless_bar_of_points(q / static_cast<double>(particles.size()), strained_by);
}

double free_end_limit(int particles_per_cell, double offset) {
  require(particles_per_cell >= 1, "a bar has particles");
  require(offset > 0.0 && offset <= 0.5, "the end of a bar is not just past a node");
  const double n = particles_per_cell, mu = 2 / (n + 1);
  const double q = (3 * n - 2) * (n - 1) / (3 * n * (n + 1));
  return std::sqrt(2 * offset / (1 + offset * (mu - q / 2)));
}

}  // namespace mpm::reference
