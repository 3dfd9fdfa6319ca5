#include "abbe/instruments/grid_encoder.h"

#include <cmath>
#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"
#include "abbe/instruments/setup_orientation.h"

namespace abbe {

GridEncoder::GridEncoder(const GridEncoderSetup& setup)
    : EquationInstrument(setup.name), noise_(setup.noise), noise_per_length_(setup.noise_per_length) {
  if (setup.placements.empty()) throw std::invalid_argument(setup.name + ": no placement of the grid");
  if (setup.head_body == setup.grid_body) throw std::invalid_argument(setup.name + ": head and grid are on one body");
  if (!(setup.noise > 0)) throw std::invalid_argument(setup.name + ".noise: not above zero");
  components_ = {{"x", false}, {"y", false}};
  const auto add_scale = [this](const char* which, const SetupNumber& number) {
    return add(pure_number(name_ + "." + which, number));
  };
  const std::size_t scale_x = add_scale("scale_x", setup.scale_x), scale_y = add_scale("scale_y", setup.scale_y);
  const std::size_t squareness = add(quantity(name_ + ".squareness", true, setup.squareness));
  const std::array<std::size_t, 3> head = add(name_ + ".head", setup.head);
  for (const GridEncoderSetup::Placement& placement : setup.placements) {
    InstrumentItem item{placement.name, setup.head_body, setup.grid_body, {head[0], head[1], head[2]}};
    position_.push_back(placement.position);
    item.quantities.push_back(add(quantity(placement.name + ".shift_x", false, placement.shift_x)));
    item.quantities.push_back(add(quantity(placement.name + ".shift_y", false, placement.shift_y)));
    for (std::size_t i = 0; i < 3; ++i) {
      item.quantities.push_back(add(quantity(placement.name + "." + "abc"[i], true, placement.angles.coordinate[i])));
    }
    for (const std::size_t of_grid : {scale_x, scale_y, squareness}) item.quantities.push_back(of_grid);
    add(std::move(item));
  }
}

double GridEncoder::standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                                         std::size_t component) const {
  return noise_ + noise_per_length_ * std::abs(readings.measured[component][reading]);
}

std::vector<InstrumentPlace> GridEncoder::places() const {
  std::vector<InstrumentPlace> places;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const std::vector<std::size_t>& q = items_[i].quantities;
    const auto value = [&](std::size_t place) { return quantities_[q[place]].value; };
    const Eigen::Matrix3d plate = rotation_zyx(value(kAngles), value(kAngles + 1), value(kAngles + 2));
    places.push_back({items_[i].name, items_[i].to,
                      position_[i] + plate * Eigen::Vector3d(value(kShift), value(kShift + 1), 0), plate, std::nullopt,
                      std::vector<std::size_t>(q.begin() + kShift, q.begin() + kScaleX)});
  }
  return places;
}

template <typename S>
void GridEncoder::equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*,
                           S* reading) const {
  using std::cos, std::tan;
  const S* q = quantities;
  using Vector = Eigen::Matrix<S, 3, 1>;
  const Vector head = seen.point(Vector(q[kHead], q[kHead + 1], q[kHead + 2]));
  const Eigen::Matrix<S, 3, 3> plate = rotation_zyx(q[kAngles], q[kAngles + 1], q[kAngles + 2]);
  Vector above = plate.transpose() * (head - position_[item].cast<S>());
  for (int k = 0; k < 2; ++k) above[k] -= q[kShift + k];
  reading[0] = (S(1) + q[kScaleX]) * (above[0] + above[1] * tan(q[kSquareness]));
  reading[1] = (S(1) + q[kScaleY]) * above[1] / cos(q[kSquareness]);
}

template class EquationInstrument<GridEncoder, 11, 2>;

}  // namespace abbe
