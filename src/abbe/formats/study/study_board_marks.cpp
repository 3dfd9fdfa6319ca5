#include <tuple>

#include "abbe/formats/study/study_direction.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/instruments/board_marks.h"

namespace abbe {

std::shared_ptr<Instrument> read_board_marks(TomlTable& table, const InstrumentContext& context) {
  using Position = BoardMarksSetup::Position;
  const bool simulated = context.simulated;
  BoardMarksSetup setup;
  setup.name = context.name;
  const Position positions[] = {Position::point, Position::line, Position::point, Position::line, Position::none};
  const std::size_t measure =
      table.word_or("measure", 0, {"points", "lines", "points-and-widths", "lines-and-widths", "widths"});
  setup.position = positions[measure];
  setup.width = measure >= 2;
  std::tie(setup.beam_body, setup.board_body) =
      read_bodies(table, {"beam_on", Body::tool}, {"boards_on", Body::workpiece});
  setup.focus = read_setup_point(table, "focus", Knowledge::exact, simulated);
  setup.beam = read_direction(table, "beam", Eigen::Vector3d::UnitZ());
  setup.beam_tilt_first =
      read_setup_number(table, "beam_tilt_first", Quantity::angle, Knowledge::exact, simulated, 0.0);
  setup.beam_tilt_second =
      read_setup_number(table, "beam_tilt_second", Quantity::angle, Knowledge::exact, simulated, 0.0);
  TomlTable noise = table.table("noise");
  if (setup.position != Position::none) setup.position_noise = read_noise(noise, "position", Quantity::length);
  if (setup.width) {
    setup.width_noise = read_noise(noise, "width", Quantity::length);
    setup.waist = read_setup_number(table, "waist", Quantity::length, Knowledge::open, simulated);
    setup.divergence = read_setup_number(table, "divergence", Quantity::length_per_length, Knowledge::open, simulated);
    if (!(setup.waist.value > 0)) table.fail_quantity("waist", Quantity::length, "is not above zero", "a width");
  }
  noise.finish();
  for (TomlTable& entry : table.tables("board")) {
    BoardMarksSetup::Board board;
    board.name = entry.text("name");
    board.position = read_setup_point(entry, "position", Knowledge::open, simulated);
    const std::string_view names[] = {"a", "b", "c"};
    for (std::size_t i = 0; i < 3; ++i) {
      board.angles.coordinate[i] = read_setup_number(entry, names[i], Quantity::angle, Knowledge::open, simulated, 0.0);
    }
    entry.finish();
    setup.boards.push_back(board);
  }
  if (setup.boards.empty()) {
    table.fail("", "the boards are missing", "[[setup.board]] with name and position_mm = [x, y, z]");
  }
  return std::make_shared<BoardMarks>(setup);
}

}  // namespace abbe
