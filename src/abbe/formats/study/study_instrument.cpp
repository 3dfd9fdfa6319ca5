#include "abbe/formats/study/study_instrument.h"

#include <stdexcept>

#include "abbe/formats/readings/tracker_file.h"

namespace abbe {
namespace {

constexpr InstrumentForm kForms[] = {
    {"tracker", read_tracker, {read_tracker_file, parse_tracker_file, tracker_file_text}},
    {"ball-bar", read_ball_bar},
    {"r-test", read_r_test},
    {"surface-probe", read_surface_probe},
    {"touch-probe", read_touch_probe},
    {"dials", read_dials},
    {"level", read_level},
    {"autocollimator", read_autocollimator},
    {"board-marks", read_board_marks},
    {"polygon", read_polygon},
    {"grid-encoder", read_grid_encoder},
    {"pose-tracker", read_pose_tracker},
    {"interferometer", read_interferometer},
    {"tracking-interferometer", read_tracking_interferometer},
};

}  // namespace

std::vector<std::string_view> instrument_words() {
  std::vector<std::string_view> words;
  for (const InstrumentForm& form : kForms) words.push_back(form.word);
  return words;
}

const InstrumentForm& instrument_form(std::string_view word) {
  for (const InstrumentForm& form : kForms) {
    if (form.word == word) return form;
  }
  throw std::invalid_argument("there is no instrument \"" + std::string(word) + "\"");
}

Body read_body(TomlTable& table, std::string_view key, Body otherwise) {
  return static_cast<Body>(table.word_or(key, static_cast<std::size_t>(otherwise), {"bed", "workpiece", "tool"}));
}

std::pair<Body, Body> read_bodies(TomlTable& table, const BodyField& one, const BodyField& other) {
  const Body first = read_body(table, one.key, one.otherwise), second = read_body(table, other.key, other.otherwise);
  refuse_same_body(table, first, second);
  return {first, second};
}

void refuse_same_body(TomlTable& table, Body a, Body b) {
  if (a == b) {
    table.fail("", "both ends of the instrument are on the same body, so that no axis moves between them",
               "another body for one of them");
  }
}

}  // namespace abbe
