#pragma once

// For formats and study: instruments of a study file, one reader each.
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/study/study.h"
#include "abbe/formats/text/toml_table.h"

namespace abbe {

/// What a reader needs to know besides its table.
struct InstrumentContext {
  std::string name;  ///< of the set-up
  const Machine& machine;
  bool simulated = false;
  bool noise_from_data = false;
};

/// What is known of an instrument in files. Adding one is a row in study_instrument.cpp.
struct InstrumentForm {
  std::string_view word;  ///< for `instrument` in a study file
  /// Reads it from the table of its set-up: everything but name, instrument, noise_from_data, plan and data.
  std::shared_ptr<Instrument> (*read)(TomlTable&, const InstrumentContext&);
  InstrumentFileForm readings{};  ///< of its files of readings
};

/// Words for `instrument` in a study file.
std::vector<std::string_view> instrument_words();
/// @param word  one of instrument_words()
const InstrumentForm& instrument_form(std::string_view word);

// One per instrument, each in a file of its own. Numbers stated as true are in SetupQuantity::truth.
std::shared_ptr<Instrument> read_tracker(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_autocollimator(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_ball_bar(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_board_marks(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_dials(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_grid_encoder(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_level(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_pose_tracker(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_polygon(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_r_test(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_surface_probe(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_touch_probe(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_interferometer(TomlTable& table, const InstrumentContext& context);
std::shared_ptr<Instrument> read_tracking_interferometer(TomlTable& table, const InstrumentContext& context);

/// Body by `key`: "bed", "workpiece" or "tool".
Body read_body(TomlTable& table, std::string_view key, Body otherwise);

/// Key of a body, and the body where the key is missing.
struct BodyField {
  std::string_view key;
  Body otherwise;
};

/// The bodies of the two ends of an instrument. @throws InputError where they are one body
std::pair<Body, Body> read_bodies(TomlTable& table, const BodyField& one, const BodyField& other);

/// Refuses an instrument whose two ends are on one body.
void refuse_same_body(TomlTable& table, Body a, Body b);

}  // namespace abbe
