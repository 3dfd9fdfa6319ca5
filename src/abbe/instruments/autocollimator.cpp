#include "abbe/instruments/autocollimator.h"

#include <stdexcept>

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

}  // namespace abbe
