#include "abbe/instruments/r_test.h"

#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"

namespace abbe {

RTest::RTest(const RTestSetup& setup) : EquationInstrument(setup.name), noise_(setup.noise) {
  if (setup.spheres.empty()) throw std::invalid_argument(setup.name + ": no sphere");
  if (setup.probes.empty() || setup.probes.size() > 4) {
    throw std::invalid_argument(setup.name + ": expected 1 to 4 probes");
  }
  const std::array<std::size_t, 3> nest = add(setup.name + ".nest", setup.nest);
  std::vector<std::size_t> shared(nest.begin(), nest.end());
  shared.push_back(add(quantity(setup.name + ".sphere_radius", false, setup.sphere_radius)));
  for (const RTestSetup::Probe& probe : setup.probes) {
    const std::string prefix = setup.name + "." + probe.name + ".";
    if (!(probe.direction.norm() > 0)) throw std::invalid_argument(prefix + "direction: has no length");
    const bool ball = probe.tip == RTestSetup::Tip::ball;
    if (ball && !(probe.tip_radius >= 0 && probe.tip_radius + setup.sphere_radius.value > 0)) {
      throw std::invalid_argument(prefix + "tip_radius: not a radius");
    }
    components_.push_back({probe.name, false});
    probes_.push_back({DirectionFrame::of(probe.direction), probe.tip, probe.tip_radius});
    shared.push_back(add(quantity(prefix + "tilt_first", true, probe.tilt_first)));
    shared.push_back(add(quantity(prefix + "tilt_second", true, probe.tilt_second)));
    shared.push_back(add(quantity(prefix + "zero", false, probe.zero)));
    shared.push_back(add(quantity(prefix + "offset_first", false, probe.offset_first)));
    shared.push_back(add(quantity(prefix + "offset_second", false, probe.offset_second)));
  }
  for (const NamedPoint& sphere : setup.spheres) {
    const std::array<std::size_t, 3> centre = add(sphere.name, sphere.centre);
    InstrumentItem item{sphere.name, setup.sphere_body, setup.nest_body, {centre.begin(), centre.end()}};
    item.quantities.insert(item.quantities.end(), shared.begin(), shared.end());
    add(std::move(item));
  }
}

double RTest::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t) const { return noise_; }

std::optional<MeetingPoints> RTest::meeting_points(std::size_t item) const {
  const std::vector<std::size_t>& q = items_[item].quantities;
  const auto value = [&](std::size_t i) { return quantities_[q[i]].value; };
  return MeetingPoints{{value(0), value(1), value(2)}, {value(3), value(4), value(5)}};
}

template <typename S>
S RTest::touched(const Eigen::Matrix<S, 3, 1>& direction, const Eigen::Matrix<S, 3, 1>& centre, const S& radii) {
  using std::sqrt;
  const S along = direction.dot(centre);
  return along + sqrt(radii * radii - centre.dot(centre) + along * along);
}

template <typename S>
void RTest::equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const {
  const Eigen::Matrix<S, 3, 1> sphere(quantities[0], quantities[1], quantities[2]);
  const Eigen::Matrix<S, 3, 1> nest(quantities[3], quantities[4], quantities[5]);
  const Eigen::Matrix<S, 3, 1> from_nest = seen.point(sphere) - nest;
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    const S* own = quantities + 7 + 5 * i;
    const Eigen::Matrix<S, 3, 1> direction = probes_[i].frame.tilted(own[0], own[1]);
    reading[i] = own[2];
    if (probes_[i].tip == RTestSetup::Tip::flat) {
      reading[i] += direction.dot(from_nest);
      continue;
    }
    const S radii = quantities[6] + S(probes_[i].tip_radius);
    Eigen::Matrix<S, 3, 1> offset;
    for (int k = 0; k < 3; ++k) {
      offset[k] = own[3] * S(probes_[i].frame.first[k]) + own[4] * S(probes_[i].frame.second[k]);
    }
    reading[i] += touched<S>(direction, from_nest - offset, radii) - touched<S>(direction, -offset, radii);
  }
}

template class EquationInstrument<RTest, 27, 4>;

}  // namespace abbe
