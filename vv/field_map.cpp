#include "vv/field_map.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

namespace mpm::vv {
namespace {

/// One particle of a two-dimensional run.
struct Place {
  const ParticleFields& fields;
  std::size_t particle;

  double displacement(std::size_t axis) const { return fields.displacement[2 * particle + axis]; }
  double velocity(std::size_t axis) const { return fields.velocity[2 * particle + axis]; }
  /// Component 0 to 3: xx, yy, zz, xy.
  double stress(std::size_t component) const { return fields.stress[4 * particle + component]; }
  double strain(std::size_t component) const { return fields.strain[4 * particle + component]; }
};

/// Diameter of Mohr's circle in the plane.
double diameter(double xx, double yy, double xy) { return std::hypot(xx - yy, 2.0 * xy); }

using Scalar = double (*)(const Place&);

struct Entry {
  FieldQuantity quantity;
  Scalar scalar;
  bool needs_strain = false;
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{
      {{"displacement", "m", "magnitude of the displacement"},
       [](const Place& p) { return std::hypot(p.displacement(0), p.displacement(1)); }},
      {{"displacement_x", "m", "displacement along x"}, [](const Place& p) { return p.displacement(0); }},
      {{"displacement_y", "m", "displacement along y"}, [](const Place& p) { return p.displacement(1); }},
      {{"speed", "m/s", "magnitude of the velocity"},
       [](const Place& p) { return std::hypot(p.velocity(0), p.velocity(1)); }},
      {{"stress_xx", "Pa", "normal stress along x, tension positive"},
       [](const Place& p) { return p.stress(0); }},
      {{"stress_yy", "Pa", "normal stress along y, tension positive"},
       [](const Place& p) { return p.stress(1); }},
      {{"stress_zz", "Pa", "normal stress out of the plane, tension positive"},
       [](const Place& p) { return p.stress(2); }},
      {{"stress_xy", "Pa", "shear stress"}, [](const Place& p) { return p.stress(3); }},
      {{"mean_stress", "Pa", "mean of the three normal stresses, tension positive"},
       [](const Place& p) { return (p.stress(0) + p.stress(1) + p.stress(2)) / 3.0; }},
      {{"max_shear_stress", "Pa", "largest shear stress in the plane"},
       [](const Place& p) { return diameter(p.stress(0), p.stress(1), p.stress(3)) / 2.0; }},
      // The engineering shear strain is twice the tensor's: the diameter of the circle, not its radius.
      {{"max_shear_strain", "-",
        "largest engineering shear strain in the plane, from the sum of the increments"},
       [](const Place& p) { return diameter(p.strain(0), p.strain(1), p.strain(3)); },
       true},
  };
  return all;
}

const Entry& entry_of(const std::string& quantity) {
  for (const Entry& entry : entries())
    if (entry.quantity.name == quantity) return entry;
  throw std::invalid_argument("no field is called \"" + quantity + "\"");
}

/// Half sizes of what a particle stands for. Scheme mpm knows points only: a square of the particle's area.
std::array<double, 2> half_sizes(const ParticleFields& fields, std::size_t particle) {
  const std::array<double, 2> own{fields.half_size[2 * particle], fields.half_size[2 * particle + 1]};
  if (own[0] > 0.0 && own[1] > 0.0) return own;
  const double current = fields.volume[particle];
  const double side = std::sqrt(current > 0.0 ? current : fields.initial_volume[particle]);
  return {side / 2.0, side / 2.0};
}

}  // namespace

const std::vector<FieldQuantity>& field_catalogue() {
  static const std::vector<FieldQuantity> catalogue = [] {
    std::vector<FieldQuantity> quantities;
    for (const Entry& entry : entries()) quantities.push_back(entry.quantity);
    return quantities;
  }();
  return catalogue;
}

FieldMap map_of(const Snapshot& snapshot, const std::string& quantity) {
  const Entry& entry = entry_of(quantity);
  const ParticleFields& fields = snapshot.fields;
  if (fields.dimension != 2)
    throw std::invalid_argument("a field is drawn of a run in two dimensions, not in " +
                                std::to_string(fields.dimension));
  if (entry.needs_strain && fields.strain.size() != fields.stress.size())
    throw std::invalid_argument("\"" + quantity + "\" needs the strain, which the scene did not sum");
  FieldMap map{entry.quantity.name, entry.quantity.unit, snapshot.moment, snapshot.time, {}, {}, {}, {}, {}};
  const std::size_t particles = fields.volume.size();
  for (std::vector<double>* field : {&map.x, &map.y, &map.half_x, &map.half_y, &map.value})
    field->reserve(particles);
  for (std::size_t p = 0; p < particles; ++p) {
    const auto [half_x, half_y] = half_sizes(fields, p);
    map.x.push_back(fields.position[2 * p]);
    map.y.push_back(fields.position[2 * p + 1]);
    map.half_x.push_back(half_x);
    map.half_y.push_back(half_y);
    map.value.push_back(entry.scalar({fields, p}));
  }
  return map;
}

}  // namespace mpm::vv
