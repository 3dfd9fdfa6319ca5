#include "abbe/formats/evaluations/evaluation_rotation_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/text/placed_table.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr std::array<const char*, 6> kProbes = {"x1", "y1", "x2", "y2", "axial", "face"};

std::vector<CsvColumn> rotation_columns() {
  std::vector<CsvColumn> columns = {{"angle", Quantity::angle}};
  for (const char* probe : kProbes) columns.push_back({probe, Quantity::length, false, false});
  return columns;
}

/// Angle without jumps at the turns; in one sense only.
std::vector<double> continued(const PlacedTable& csv, const CsvValues& values) {
  std::vector<double> angle(values.numbers);
  double turns = 0, sense = 0;
  for (std::size_t i = 1; i < angle.size(); ++i) {
    const double raw = values.numbers[i] - values.numbers[i - 1];
    // Half a turn is taken as it stands: readings are far closer, and a file with such steps is refused as uneven.
    if (std::abs(raw) > kTurn / 2 && std::abs(raw) < 1.5 * kTurn) turns += raw < 0 ? 1 : -1;
    angle[i] = values.numbers[i] + kTurn * turns;
    const double step = angle[i] - angle[i - 1];
    if (sense == 0) sense = step;
    if (step == 0 || (step > 0) != (sense > 0)) {
      throw InputError(csv.place(i, values.header),
                       fmt::format("the angle {} the row before", step == 0 ? "is that of" : "turns back against"),
                       "readings in the order of time, with an angle that only rises or only falls");
    }
  }
  return angle;
}

RotationReadings rotation_of(PlacedTable csv) {
  RotationReadings readings;
  const std::array<std::vector<double>*, 6> probes = {&readings.x1, &readings.y1,    &readings.x2,
                                                      &readings.y2, &readings.axial, &readings.face};
  bool any = false;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    any = any || csv.columns[k + 1].present;
    *probes[k] = std::move(csv.columns[k + 1].numbers);
  }
  if (!any) {
    throw InputError(csv.place("x1"), "there is no column of a probe",
                     "at least one of x1_um, y1_um, x2_um, y2_um, axial_um, face_um");
  }
  readings.angle = continued(csv, csv.columns[0]);
  return readings;
}

}  // namespace

RotationReadings read_rotation(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_readable_table(path, rotation_columns(), mapping,
                             [&](std::string_view text) { return parse_rotation(text, path.string(), mapping); });
}

RotationReadings parse_rotation(std::string_view text, const std::string& file, const ColumnMapping& mapping) {
  return rotation_of({text, file, rotation_columns(), mapping});
}

RotationReadings parse_rotation(const NamedColumns& columns) { return rotation_of({columns, rotation_columns()}); }

}  // namespace abbe
