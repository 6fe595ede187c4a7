#pragma once

#include <variant>

#include "solver/compensated_sum.hpp"
#include "solver/lanes.hpp"
#include "solver/linear_elastic.hpp"
#include "solver/mohr_coulomb.hpp"
#include "solver/neo_hookean.hpp"
#include "solver/particles.hpp"
#include "solver/zhang_elastic.hpp"

namespace mpm {

/// The laws a body can follow in `Dim` dimensions.
template <int Dim, class Real>
struct Laws {
  using Any = std::variant<LinearElasticLaw<Dim, Real>, MohrCoulombLaw<Real>, NeoHookeanLaw<Dim, Real>>;
};
template <class Real>
struct Laws<1, Real> {
  using Any = std::variant<LinearElasticLaw<1, Real>, ZhangElasticLaw<Real>, NeoHookeanLaw<1, Real>>;
};

/// The law of a material. The scene has been checked: a law exists in this dimension.
template <int Dim, class Real>
typename Laws<Dim, Real>::Any law_of(const Material& material) {
  if constexpr (Dim == 1) {
    if (const auto* zhang = std::get_if<ZhangElastic>(&material)) return ZhangElasticLaw<Real>(*zhang);
  } else {
    if (const auto* soil = std::get_if<MohrCoulomb>(&material)) return MohrCoulombLaw<Real>(*soil);
  }
  if (const auto* rubber = std::get_if<NeoHookean>(&material)) return NeoHookeanLaw<Dim, Real>(*rubber);
  return LinearElasticLaw<Dim, Real>(std::get<LinearElastic>(material));
}

/// What the velocity gradient does to a particle, or lanes of them, in one step.
template <int Dim, class Value>
struct Deformation {
  SymmetricTensor<Dim, Value> strain_increment;  ///< [-]
  Value rotation;                                ///< in the plane, anticlockwise [rad]
};

/// Deformation over a time step [Kiriyama15, Eq. 10a]; the rotation is half the curl times the time step.
template <int Dim, class Value>
Deformation<Dim, Value> deformation_of(const std::array<Vector<Dim, Value>, Dim>& velocity_gradient,
                                       const Value& time_step) {
  Deformation<Dim, Value> deformation{symmetric_part<Dim, Value>(velocity_gradient), Value(0)};
  for (Value& component : deformation.strain_increment) component = time_step * component;
  if constexpr (Dim == 2) {
    deformation.rotation = time_step * (velocity_gradient[1][0] - velocity_gradient[0][1]) / 2;
  }
  return deformation;
}

/// Gives a deformation another dilation, and leaves its deviator in the plane: both directions take half of
/// the change [Hughes80].
template <class Value>
void set_dilation(const Value& dilation, Deformation<2, Value>& deformation) {
  const Value change = (dilation - trace<2, Value>(deformation.strain_increment)) / 2;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    deformation.strain_increment[axis] = deformation.strain_increment[axis] + change;
  }
}

/// Whether a law's `update` reads the ratio of volumes; without a body of such a law, initial volumes are not
/// stored.
template <class Law>
inline constexpr bool follows_volume = false;
template <class Real>
inline constexpr bool follows_volume<ZhangElasticLaw<Real>> = true;
template <int Dim, class Real>
inline constexpr bool follows_volume<NeoHookeanLaw<Dim, Real>> = true;

/// Whether a law's stress is the sum of what the strain increments add to it, so that the sum can be compensated. Of
/// Mohr–Coulomb it is not: where soil yields, the law puts the stress on the yield surface, whatever it was.
template <class Law>
inline constexpr bool sums_stress = false;
template <int Dim, class Real>
inline constexpr bool sums_stress<LinearElasticLaw<Dim, Real>> = true;

/// Updates particles whose bodies follow one law, lanes of them at a time.
template <int Dim, class Real>
class StressUpdate {
 public:
  using Value = Lanes<Real>;
  using Points = Particles<Dim, Real>;
  static constexpr std::size_t components = Points::components;

  explicit StressUpdate(const Scene& scene)
      : sums_strain_(scene.sums_strain),
        sums_work_(scene.sums_work),
        turns_stress_(scene.objectivity == Objectivity::jaumann),
        compensates_(scene.compensated_sums) {}

  /// Volume, then stress of the particles in lanes of slots [Kiriyama15, Eqs. 11 and 12]. The Jaumann rate is
  /// integrated exactly for a constant spin: the stress is turned by the step's rotation.
  template <class Law>
  [[gnu::always_inline]] void operator()(const Law& law, const Deformation<Dim, Value>& deformation,
                                         Eigen::Index slot, Points& particles) const {
    if (compensates_) [[unlikely]] return update_compensated(law, deformation, slot, particles);
    SymmetricTensor<Dim, Value> stress = turned(stress_of(slot, particles), deformation);
    sum_strain(deformation, slot, particles);
    const auto& increment = deformation.strain_increment;
    const Value volume = load<Value>(&particles.volume[slot]) * (1 + trace<Dim, Value>(increment));
    Value volume_ratio(1);
    if constexpr (follows_volume<Law>) volume_ratio = volume / load<Value>(&particles.initial_volume[slot]);
    stress = law.update(stress, increment, volume_ratio);
    // The stress before is read once more rather than kept: who sums no work has the registers for the law.
    if (sums_work_) {
      sum_work(turned(stress_of(slot, particles), deformation), stress, increment,
               load<Value>(&particles.volume[slot]), slot, particles);
    }
    store(volume, &particles.volume[slot]);
    for (std::size_t c = 0; c < components; ++c) store(stress[c], &particles.stress[c][slot]);
  }

  /// Deformation gradient, volume and stress of a neo-Hookean body's particles: F grows by (I + L dt) F,
  /// exact for particles that move with their velocity gradient L.
  void operator()(const NeoHookeanLaw<2, Real>& law, const Deformation<2, Value>& deformation,
                  Eigen::Index slot, Points& particles) const requires(Dim == 2) {
    const auto& increment = deformation.strain_increment;
    const Value xx = 1 + increment[0], yy = 1 + increment[1];
    const Value xy = increment[3] - deformation.rotation, yx = increment[3] + deformation.rotation;
    std::array<Value, 4> old;
    for (std::size_t k = 0; k < 4; ++k) old[k] = load<Value>(&particles.deformation_gradient[k][slot]);
    std::array<Value, 4> f{xx * old[0] + xy * old[2], xx * old[1] + xy * old[3],
                           yx * old[0] + yy * old[2], yx * old[1] + yy * old[3]};
    if (compensates_) [[unlikely]] {
      f = {increment[0] * old[0] + xy * old[2], increment[0] * old[1] + xy * old[3],
           yx * old[0] + increment[1] * old[2], yx * old[1] + increment[1] * old[3]};
      for (std::size_t k = 0; k < 4; ++k) {
        Real* const sum = &particles.deformation_gradient[k][slot];
        add_compensated(f[k], sum, &particles.low.deformation_gradient[k][slot]);
        f[k] = load<Value>(sum);
      }
    }
    const Value volume_ratio = f[0] * f[3] - f[1] * f[2];
    for (std::size_t k = 0; k < 4; ++k) store(f[k], &particles.deformation_gradient[k][slot]);
    sum_strain(deformation, slot, particles);
    const SymmetricTensor<2, Value> stress = law.stress(f, volume_ratio);
    if (sums_work_) {
      const SymmetricTensor<2, Value> before = rotated(stress_of(slot, particles), deformation.rotation);
      sum_work(before, stress, increment, load<Value>(&particles.volume[slot]), slot, particles);
    }
    store(volume_ratio * load<Value>(&particles.initial_volume[slot]), &particles.volume[slot]);
    for (std::size_t c = 0; c < components; ++c) store(stress[c], &particles.stress[c][slot]);
  }

 private:
  /// The same with sums that keep what rounding cuts off them; turning the stress rounds it as ever.
  template <class Law>
  [[gnu::noinline]] void update_compensated(const Law& law, Deformation<Dim, Value> deformation, Eigen::Index slot,
                          Points& particles) const {
    const SymmetricTensor<Dim, Value> before = turned(stress_of(slot, particles), deformation);
    sum_strain(deformation, slot, particles);
    const auto& increment = deformation.strain_increment;
    Real* const volume = &particles.volume[slot];
    const Value old_volume = load<Value>(volume);
    add_compensated(old_volume * trace<Dim, Value>(increment), volume, &particles.low.volume[0][slot]);
    Value volume_ratio(1);
    if constexpr (follows_volume<Law>) volume_ratio = load<Value>(volume) / load<Value>(&particles.initial_volume[slot]);
    SymmetricTensor<Dim, Value> stress = before;
    if constexpr (sums_stress<Law>) {
      SymmetricTensor<Dim, Value> none;
      none.fill(Value(0));
      stress = law.update(none, increment, volume_ratio);
      for (std::size_t c = 0; c < components; ++c) {
        Real* const sum = &particles.stress[c][slot];
        store(before[c], sum);
        add_compensated(stress[c], sum, &particles.low.stress[c][slot]);
        stress[c] = load<Value>(sum);
      }
    } else {
      stress = law.update(stress, increment, volume_ratio);
      for (std::size_t c = 0; c < components; ++c) store(stress[c], &particles.stress[c][slot]);
    }
    if (sums_work_) sum_work(before, stress, increment, old_volume, slot, particles);
  }

  void sum_strain(const Deformation<Dim, Value>& deformation, Eigen::Index slot, Points& particles) const {
    if (!sums_strain_) return;
    for (std::size_t c = 0; c < components; ++c) {
      Real* const strain = &particles.strain[c][slot];
      store(load<Value>(strain) + deformation.strain_increment[c], strain);
    }
  }

  /// Adds the work of the stress over the step: of its mean, on the volume at the step's start, to which the
  /// increment refers. What a pressure does is the pressure times the change of
  /// volume then. `before` is the stress at the start turned with the material, on which a turn does no work.
  static void sum_work(const SymmetricTensor<Dim, Value>& before, const SymmetricTensor<Dim, Value>& after,
                       const SymmetricTensor<Dim, Value>& strain_increment, const Value& volume,
                       Eigen::Index slot, Points& particles) {
    SymmetricTensor<Dim, Value> mean;
    for (std::size_t c = 0; c < components; ++c) mean[c] = (before[c] + after[c]) / 2;
    Real* const work = &particles.stress_work[0][slot];
    store(load<Value>(work) + volume * contraction<Dim, Value>(mean, strain_increment), work);
  }

  /// The stress turned with the material, if it turns.
  SymmetricTensor<Dim, Value> turned(const SymmetricTensor<Dim, Value>& stress,
                                     const Deformation<Dim, Value>& deformation) const {
    if constexpr (Dim == 2) {
      if (turns_stress_) return rotated(stress, deformation.rotation);
    }
    return stress;
  }

  static SymmetricTensor<Dim, Value> stress_of(Eigen::Index slot, const Points& particles) {
    SymmetricTensor<Dim, Value> stress;
    for (std::size_t c = 0; c < components; ++c) stress[c] = load<Value>(&particles.stress[c][slot]);
    return stress;
  }

  bool sums_strain_, sums_work_, turns_stress_, compensates_;
};

}  // namespace mpm
