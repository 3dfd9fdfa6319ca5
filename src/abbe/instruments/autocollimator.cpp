#include "abbe/instruments/autocollimator.h"

#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"

namespace abbe {

Autocollimator::Autocollimator(const AutocollimatorSetup& setup)
    : EquationInstrument(setup.name),
      half_tangent_(setup.indication == AutocollimatorSetup::Indication::half_tangent),
      noise_(setup.noise) {
  components_ = {{"first", true}, {"second", true}};
  if (!(setup.beam.norm() > 0) ||
      !(setup.beam.cross(setup.first).norm() > 1e-3 * setup.beam.norm() * setup.first.norm())) {
    throw std::invalid_argument(setup.name + ": beam and first have no length or are parallel");
  }
  beam_ = setup.beam.normalized();
  across_[0] = (setup.first - setup.first.dot(beam_) * beam_).normalized();
  across_[1] = beam_.cross(across_[0]);
  mirror_ = DirectionFrame::of(-beam_);
  add(InstrumentItem{setup.name,
                     setup.mirror_body,
                     setup.collimator_body,
                     {add(quantity(setup.name + ".mirror_tilt_first", true, setup.mirror_tilt_first)),
                      add(quantity(setup.name + ".mirror_tilt_second", true, setup.mirror_tilt_second)),
                      add(quantity(setup.name + ".zero_first", true, setup.zero_first)),
                      add(quantity(setup.name + ".zero_second", true, setup.zero_second))}});
}

double Autocollimator::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t) const {
  return noise_;
}

template <typename S>
void Autocollimator::equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*,
                              S* reading) const {
  using std::atan2;
  const Eigen::Matrix<S, 3, 1> normal = seen.rotation * mirror_.tilted(quantities[0], quantities[1]);
  const Eigen::Matrix<S, 3, 1> beam = beam_.template cast<S>();
  const S along = beam.dot(normal);
  const Eigen::Matrix<S, 3, 1> back = beam - normal * (along * S(2.0));
  const S forward = -back.dot(beam);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Matrix<S, 3, 1> across = across_[i].template cast<S>();
    const S deflected = back.dot(across);
    const S raw = half_tangent_ ? S(deflected / forward) : S(atan2(deflected, forward));
    reading[i] = raw * S(0.5) + quantities[2 + i];
  }
}

template class EquationInstrument<Autocollimator, 4, 2>;

}  // namespace abbe
