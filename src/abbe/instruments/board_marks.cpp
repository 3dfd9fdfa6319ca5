#include "abbe/instruments/board_marks.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"

namespace abbe {

BoardMarks::BoardMarks(const BoardMarksSetup& setup)
    : EquationInstrument(setup.name),
      position_(setup.position),
      width_(setup.width),
      position_noise_(setup.position_noise),
      width_noise_(setup.width_noise) {
  using Position = BoardMarksSetup::Position;
  if (setup.boards.empty()) throw std::invalid_argument(setup.name + ": no board");
  if (position_ == Position::none && !width_) throw std::invalid_argument(setup.name + ": nothing is read");
  if (!(setup.beam.norm() > 0)) throw std::invalid_argument(setup.name + ".beam: has no length");
  if (!(setup.waist.value > 0)) throw std::invalid_argument(setup.name + ".waist: not above zero");
  if (position_ == Position::point) components_ = {{"u", false}, {"v", false}};
  if (position_ == Position::line) {
    components_ = {{"position", false}};
    inputs_ = {{"direction", true}};
  }
  if (width_) components_.push_back({"width", false});
  beam_ = DirectionFrame::of(setup.beam);
  const std::array<std::size_t, 3> focus = add(setup.name + ".focus", setup.focus);
  const std::size_t tilt_first = add(quantity(setup.name + ".beam_tilt_first", true, setup.beam_tilt_first));
  const std::size_t tilt_second = add(quantity(setup.name + ".beam_tilt_second", true, setup.beam_tilt_second));
  SetupQuantity waist_quantity = quantity(setup.name + ".waist", false, setup.waist);
  waist_quantity.scale = 0.01;
  const std::size_t waist = add(std::move(waist_quantity));
  SetupQuantity divergence_quantity = quantity(setup.name + ".divergence", true, setup.divergence);
  divergence_quantity.scale = 0.01;
  const std::size_t divergence = add(std::move(divergence_quantity));
  for (const BoardMarksSetup::Board& board : setup.boards) {
    const std::array<std::size_t, 3> p = add(board.name + ".position", board.position);
    std::array<std::size_t, 3> a{};
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = add(quantity(board.name + "." + "abc"[i], true, board.angles.coordinate[i]));
    }
    add(InstrumentItem{board.name,
                       setup.beam_body,
                       setup.board_body,
                       {focus[0], focus[1], focus[2], tilt_first, tilt_second, p[0], p[1], p[2], a[0], a[1], a[2],
                        waist, divergence}});
  }
}

double BoardMarks::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t component) const {
  return width_ && component + 1 == components_.size() ? width_noise_ : position_noise_;
}

std::vector<InstrumentPlace> BoardMarks::places() const {
  std::vector<InstrumentPlace> places;
  for (const InstrumentItem& item : items_) {
    const std::vector<std::size_t>& q = item.quantities;
    const auto value = [&](std::size_t i) { return quantities_[q[i]].value; };
    if (places.empty()) {
      places.push_back({name_ + ".beam", item.from, Eigen::Vector3d(value(0), value(1), value(2)), std::nullopt,
                        Eigen::Vector3d(beam_.tilted(value(3), value(4))),
                        std::vector<std::size_t>(q.begin(), q.begin() + 5)});
    }
    places.push_back({item.name, item.to, Eigen::Vector3d(value(5), value(6), value(7)),
                      Eigen::Matrix3d(rotation_zyx(value(8), value(9), value(10))), std::nullopt,
                      std::vector<std::size_t>(q.begin() + 5, q.begin() + 11)});
  }
  return places;
}

std::vector<std::vector<double>> BoardMarks::planned_inputs(std::size_t) const {
  if (position_ != BoardMarksSetup::Position::line) return {{}};
  return {{0}, {std::numbers::pi / 2}};
}

std::optional<MeetingPoints> BoardMarks::meeting_points(std::size_t item) const {
  const std::vector<std::size_t>& q = items_[item].quantities;
  const auto value = [&](std::size_t i) { return quantities_[q[i]].value; };
  return MeetingPoints{{value(0), value(1), value(2)}, {value(5), value(6), value(7)}};
}

template <typename S>
void BoardMarks::equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double* inputs,
                          S* reading) const {
  using std::sqrt;
  const S* q = quantities;
  const Eigen::Matrix<S, 3, 1> focus = seen.point(Eigen::Matrix<S, 3, 1>(q[0], q[1], q[2]));
  const Eigen::Matrix<S, 3, 1> beam = seen.rotation * beam_.tilted(q[3], q[4]);
  const Eigen::Matrix<S, 3, 1> origin(q[5], q[6], q[7]);
  const Eigen::Matrix<S, 3, 3> board = rotation_zyx(q[8], q[9], q[10]);
  // Both in the board's own axes: the surface is w = 0.
  const Eigen::Matrix<S, 3, 1> from = board.transpose() * (focus - origin), along = board.transpose() * beam;
  const S distance = -from[2] / along[2];
  const S u = from[0] + distance * along[0], v = from[1] + distance * along[1];
  int row = 0;
  if (position_ == BoardMarksSetup::Position::point) {
    reading[row++] = u;
    reading[row++] = v;
  } else if (position_ == BoardMarksSetup::Position::line) {
    reading[row++] = S(std::cos(inputs[0])) * u + S(std::sin(inputs[0])) * v;
  }
  if (width_) {
    const S spread = q[12] * distance;
    reading[row] = sqrt(q[11] * q[11] + spread * spread);
  }
}

template class EquationInstrument<BoardMarks, 13, 3>;

}  // namespace abbe
