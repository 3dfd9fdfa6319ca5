#include <fmt/format.h>

#include <tuple>

#include "abbe/formats/study/study_direction.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/instruments/dial_indicators.h"

namespace abbe {
namespace {

constexpr std::size_t kMostDials = 6;

DialIndicatorsSetup::Face read_face(TomlTable& table, bool simulated) {
  DialIndicatorsSetup::Face face;
  face.name = table.text("name");
  const std::vector<double> point = table.numbers("point", Quantity::length, 3);
  face.point = {point[0], point[1], point[2]};
  face.normal = read_direction(table, "normal");
  face.offset = read_setup_number(table, "offset", Quantity::length, Knowledge::open, simulated, 0.0);
  face.tilt_first = read_setup_number(table, "tilt_first", Quantity::angle, Knowledge::open, simulated, 0.0);
  face.tilt_second = read_setup_number(table, "tilt_second", Quantity::angle, Knowledge::open, simulated, 0.0);
  table.finish();
  return face;
}

DialIndicatorsSetup::Dial read_dial(TomlTable& table, const std::vector<DialIndicatorsSetup::Face>& faces,
                                    bool simulated) {
  DialIndicatorsSetup::Dial dial;
  dial.name = table.text("name");
  dial.position = read_setup_point(table, "position", Knowledge::exact, simulated);
  dial.direction = read_direction(table, "direction");
  dial.zero = read_setup_number(table, "zero", Quantity::length, Knowledge::exact, simulated, 0.0);
  const std::string face = table.text_or("face", faces.front().name);
  std::string names;
  for (dial.face = 0; dial.face < faces.size() && faces[dial.face].name != face; ++dial.face) {
    names += (names.empty() ? "" : ", ") + faces[dial.face].name;
  }
  if (dial.face == faces.size()) table.fail("face", fmt::format("there is no face \"{}\"", face), "one of " + names);
  table.finish();
  return dial;
}

DialIndicatorsSetup::Arrangement read_arrangement(TomlTable& table, std::string name,
                                                  const std::vector<DialIndicatorsSetup::Face>& faces, bool simulated) {
  DialIndicatorsSetup::Arrangement arrangement;
  arrangement.name = std::move(name);
  for (TomlTable& entry : table.tables("dial")) arrangement.dials.push_back(read_dial(entry, faces, simulated));
  if (arrangement.dials.empty() || arrangement.dials.size() > kMostDials) {
    table.fail("", "there are no dials or too many", "one to six [[...dial]] with name, position_mm and direction");
  }
  return arrangement;
}

}  // namespace

std::shared_ptr<Instrument> read_dials(TomlTable& table, const InstrumentContext& context) {
  DialIndicatorsSetup setup;
  setup.name = context.name;
  std::tie(setup.carriage_body, setup.face_body) =
      read_bodies(table, {"dials_on", Body::tool}, {"faces_on", Body::workpiece});
  TomlTable noise = table.table("noise");
  setup.noise = read_noise(noise, "indication", Quantity::length);
  setup.flatness = noise.size_or("flatness", Quantity::length, 0);
  noise.finish();
  for (TomlTable& entry : table.tables("face")) setup.faces.push_back(read_face(entry, context.simulated));
  if (setup.faces.empty()) {
    table.fail("", "the reference faces are missing", "[[setup.face]] with name, point_mm and normal");
  }
  if (table.has("dial")) {
    if (table.has("arrangement")) table.fail("dial", "is given together with arrangements", "the dials in one of them");
    setup.arrangements.push_back(read_arrangement(table, context.name, setup.faces, context.simulated));
  }
  for (TomlTable& entry : table.tables("arrangement")) {
    const std::string name = entry.text("name");
    setup.arrangements.push_back(read_arrangement(entry, name, setup.faces, context.simulated));
    entry.finish();
    if (setup.arrangements.back().dials.size() != setup.arrangements.front().dials.size()) {
      entry.fail("", "has another number of dials than the first arrangement", "as many dials in every arrangement");
    }
  }
  if (setup.arrangements.empty()) {
    table.fail("", "the dials are missing", "[[setup.dial]] with name, position_mm, direction and face");
  }
  return std::make_shared<DialIndicators>(setup);
}

}  // namespace abbe
