#include "abbe/instruments/electronic_level.h"

#include <cmath>
#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"

namespace abbe {

ElectronicLevel::ElectronicLevel(const ElectronicLevelSetup& setup)
    : EquationInstrument(setup.name), relative_(setup.relative), noise_(setup.noise) {
  if (setup.axes.empty() || setup.axes.size() > 2) {
    throw std::invalid_argument(setup.name + ": expected one or two sensitive axes");
  }
  if (!(setup.up.norm() > 0)) throw std::invalid_argument(setup.name + ".up: has no length");
  up_ = DirectionFrame::of(setup.up);
  InstrumentItem item{setup.name, setup.body, setup.reference_body, {}};
  item.quantities = {add(quantity(setup.name + ".up_tilt_first", true, setup.up_tilt_first)),
                     add(quantity(setup.name + ".up_tilt_second", true, setup.up_tilt_second))};
  for (const ElectronicLevelSetup::Axis& axis : setup.axes) {
    if (!(axis.direction.norm() > 0) || std::abs(axis.direction.normalized().dot(up_.direction)) > 0.99) {
      throw std::invalid_argument(setup.name + "." + axis.name + ".direction: is vertical or has no length");
    }
    directions_.push_back(axis.direction.normalized());
    components_.push_back({axis.name, true});
    item.quantities.push_back(add(quantity(setup.name + "." + axis.name + ".zero", true, axis.zero)));
  }
  add(std::move(item));
}

double ElectronicLevel::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t) const {
  return noise_;
}

template <typename S>
void ElectronicLevel::equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*,
                               S* reading) const {
  using std::asin;
  const Eigen::Matrix<S, 3, 1> up = up_.tilted(quantities[0], quantities[1]);
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    reading[i] = asin(up.dot(seen.direction(directions_[i]))) + quantities[2 + i];
    if (relative_) {
      const Eigen::Matrix<S, 3, 1> at_rest = directions_[i].template cast<S>();
      reading[i] -= asin(up.dot(at_rest));
    }
  }
}

template class EquationInstrument<ElectronicLevel, 4, 2>;

}  // namespace abbe
