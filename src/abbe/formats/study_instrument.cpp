#include "abbe/formats/study_instrument.h"

namespace abbe {
namespace {

struct Kind {
  std::string_view word;
  std::shared_ptr<Instrument> (*read)(TomlTable&, const InstrumentContext&);
};

constexpr Kind kKinds[] = {
    {"ball-bar", read_ball_bar},
    {"r-test", read_r_test},
    {"surface-probe", read_surface_probe},
    {"touch-probe", read_touch_probe},
    {"dials", read_dials},
    {"level", read_level},
    {"autocollimator", read_autocollimator},
    {"board-marks", read_board_marks},
    {"polygon", read_polygon},
    {"interferometer", read_interferometer},
    {"tracking-interferometer", read_tracking_interferometer},
};

}  // namespace

std::vector<std::string_view> instrument_words() {
  std::vector<std::string_view> words;
  for (const Kind& kind : kKinds) words.push_back(kind.word);
  return words;
}

std::shared_ptr<Instrument> read_instrument(std::size_t index, TomlTable& table, const InstrumentContext& context) {
  return kKinds[index].read(table, context);
}

Body read_body(TomlTable& table, std::string_view key, Body otherwise) {
  return static_cast<Body>(table.word_or(key, static_cast<std::size_t>(otherwise), {"bed", "workpiece", "tool"}));
}

void refuse_same_body(TomlTable& table, Body a, Body b) {
  if (a == b) {
    table.fail("", "both ends of the instrument are on the same body, so that no axis moves between them",
               "another body for one of them");
  }
}

}  // namespace abbe
