#include "abbe/instruments/board_marks.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

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

std::vector<std::vector<double>> BoardMarks::planned_inputs(std::size_t) const {
  if (position_ != BoardMarksSetup::Position::line) return {{}};
  return {{0}, {std::numbers::pi / 2}};
}

std::optional<MeetingPoints> BoardMarks::meeting_points(std::size_t item) const {
  const std::vector<std::size_t>& q = items_[item].quantities;
  const auto value = [&](std::size_t i) { return quantities_[q[i]].value; };
  return MeetingPoints{{value(0), value(1), value(2)}, {value(5), value(6), value(7)}};
}

}  // namespace abbe
