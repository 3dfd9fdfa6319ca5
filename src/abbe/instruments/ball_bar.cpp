#include "abbe/instruments/ball_bar.h"

#include <cmath>
#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"

namespace abbe {

BallBar::BallBar(const BallBarSetup& setup)
    : EquationInstrument(setup.name), noise_(setup.noise), noise_per_length_(setup.noise_per_length) {
  if (setup.balls.empty()) throw std::invalid_argument(setup.name + ": no ball");
  components_ = {{"length", false}};
  const std::array<std::size_t, 3> spindle = add(setup.name + ".spindle_ball", setup.spindle_ball);
  const std::size_t deviation = add(quantity(setup.name + ".length_deviation", false, setup.length_deviation));
  for (const NamedPoint& ball : setup.balls) {
    const std::array<std::size_t, 3> centre = add(ball.name, ball.centre);
    add(InstrumentItem{ball.name,
                       setup.spindle_body,
                       setup.table_body,
                       {spindle[0], spindle[1], spindle[2], centre[0], centre[1], centre[2], deviation}});
  }
}

double BallBar::standard_uncertainty(const InstrumentReadings& readings, std::size_t reading, std::size_t) const {
  return noise_ + noise_per_length_ * std::abs(readings.measured[0][reading]);
}

std::optional<MeetingPoints> BallBar::meeting_points(std::size_t item) const {
  const auto at = [&](std::size_t first) -> Eigen::Vector3d {
    const std::vector<std::size_t>& q = items_[item].quantities;
    return {quantities_[q[first]].value, quantities_[q[first + 1]].value, quantities_[q[first + 2]].value};
  };
  return MeetingPoints{at(0), at(3)};
}

template <typename S>
void BallBar::equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const {
  using std::sqrt;
  const Eigen::Matrix<S, 3, 1> spindle(quantities[0], quantities[1], quantities[2]);
  const Eigen::Matrix<S, 3, 1> table(quantities[3], quantities[4], quantities[5]);
  const Eigen::Matrix<S, 3, 1> bar = seen.point(spindle) - table;
  reading[0] = sqrt(bar.dot(bar)) + quantities[6];
}

template class EquationInstrument<BallBar, 7, 1>;

}  // namespace abbe
