#include "abbe/study/imports/imported_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "abbe/formats/evaluations/evaluation_circular_file.h"
#include "abbe/formats/evaluations/evaluation_positioning.h"
#include "abbe/formats/import/known_program.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/unit.h"
#include "abbe/study/imports/frame_sense.h"
#include "abbe/study/imports/imported_instrument.h"

namespace abbe {
namespace {

constexpr const char* kWrittenName = "imported.csv";
// Radial deviations are added to a nominal radius, which a table of them need not state. Beside this one none is large.
constexpr double kAnyRadius = 1e9;

const Machine& machine_of_import(const ImportRequest& request) {
  static const Machine none;
  return request.machine ? *request.machine : none;
}

void take_mapping(const ImportRequest& request, ImportedTable& result) {
  const ImportMapping& mapping = *request.mapping;
  if (request.kind && *request.kind != mapping.kind) {
    throw InputError({.field = "--as"},
                     fmt::format("is not the kind of the mapping, {}", import_kind_name(mapping.kind)),
                     "the same kind, or no --as");
  }
  if (mapping.kind == ImportKind::tracker && !request.machine) {
    throw InputError({.field = "--machine"}, "is missing", "the machine whose commands the table has");
  }
  result.found = layout_as_given(request.text.text, request.file, mapping.layout);
  result.mapping = mapping;
  result.kind_reason = "as the mapping says";
  result.found.reasons.emplace_back("layout as the mapping says");
  std::vector<bool> is_read(result.found.names.size());
  for (const MappedColumn& column : mapping.columns) {
    ProposedColumn& taken = result.columns.emplace_back();
    taken.column = column;
    taken.reason = "as the mapping says";
    const std::vector<std::string>& names = result.found.names;
    taken.source = column.from_column > 0
                       ? column.from_column - 1
                       : static_cast<std::size_t>(std::find(names.begin(), names.end(), column.from) - names.begin());
    if (taken.source < is_read.size()) is_read[taken.source] = true;
  }
  for (std::size_t k = 0; k < is_read.size(); ++k) {
    if (!is_read[k]) result.not_read.push_back(column_words(k, result.found.names[k]));
  }
}

void propose(const ImportRequest& request, const ImportHints& hints, ImportedTable& result) {
  ProposedMapping proposed = propose_mapping(request.text.text, request.file, result.found, request.kind,
                                             request.machine ? &*request.machine : nullptr, hints);
  result.mapping = {};
  result.mapping.kind = proposed.kind;
  result.mapping.layout = result.found.layout;
  if (request.text.given) result.mapping.encoding = request.text.encoding;
  for (const ProposedColumn& column : proposed.columns) result.mapping.columns.push_back(column.column);
  result.kind_reason = std::move(proposed.reason);
  result.columns = std::move(proposed.columns);
  result.not_read = std::move(proposed.not_read);
}

void propose_table(const ImportRequest& request, ImportedTable& result) {
  result.found = find_layout(request.text.text, request.file, request.hints.layout);
  ImportHints hints = request.hints;
  if (request.machine && result.found.layout.header_line == 0) {
    // Of columns without names the machine has to tell whether they are angles: try_polar().
    hints.clockwise.reset();
    hints.zenith.reset();
  }
  propose(request, hints, result);
}

/// As propose_table(); what it refuses may be a file of a known program.
void take_proposal(const ImportRequest& request, ImportedTable& result) {
  try {
    propose_table(request, result);
  } catch (const InputError& error) {
    const std::optional<KnownProgram> known = known_program(request.text.text);
    if (!known || error.place().file != request.file) throw;
    throw InputError(error.place(), fmt::format("{}; {}", error.problem(), known->what), std::string(known->advice));
  }
}

CsvColumn label_column(const char* name) {
  CsvColumn column{name, Quantity::dimensionless, true};
  column.is_label = true;
  return column;
}

/// The readings of a tracker; nothing for other kinds.
std::optional<MeasurementTable> read_back(const ImportedTable& result, const Machine& machine, int threads) {
  const std::string& csv = result.rows.csv;
  switch (result.mapping.kind) {
    case ImportKind::points:
      parse_point_cloud(csv, kWrittenName, {.unit = {}, .mapping = {}, .threads = threads});
      return std::nullopt;
    case ImportKind::tracker:
      return parse_measurements(csv, kWrittenName, machine, {.mapping = {}, .threads = threads});
    case ImportKind::positioning:
      parse_positioning(csv, kWrittenName);
      return std::nullopt;
    case ImportKind::circular:
      parse_circular(csv, kWrittenName, kAnyRadius);
      return std::nullopt;
    case ImportKind::temperatures:
      read_csv(csv, kWrittenName,
               {label_column("time"), label_column("sensor"), {"temperature_degC", Quantity::dimensionless}}, {},
               threads);
      return std::nullopt;
  }
  return std::nullopt;
}

/// What the reader says of the CSV, with the line and the column of the table.
[[noreturn]] void refuse_table_as_read(const ImportRequest& request, const ImportedTable& result,
                                       const InputError& error) {
  InputError::Place place{.file = request.file};
  if (error.place().line >= 2) {
    place.line = imported_line(request.text.text, result.found.layout, error.place().line - 2);
  }
  place.field = error.place().field;
  for (const ProposedColumn& column : result.columns) {
    if (column.column.name != place.field) continue;
    const std::string& name = result.found.names[column.source];
    if (name != place.field) place.field += fmt::format(" (column {})", column.source + 1);
    break;
  }
  throw InputError(std::move(place), error.problem(), error.expected());
}

std::optional<MeasurementTable> convert(const ImportRequest& request, const Machine& machine, ImportedTable& result) {
  result.rows = imported_rows(request.text.text, request.file, result.found, result.mapping, machine, request.threads);
  try {
    return read_back(result, machine, request.threads);
  } catch (const InputError& error) {
    refuse_table_as_read(request, result, error);
  }
}

/// The same of a file of an instrument.
void convert(const ImportRequest& request, const InstrumentRows& rows, ImportedTable& result) {
  try {
    result.rows = imported_rows(rows.text, request.file, result.found, result.mapping, Machine(), request.threads);
  } catch (const InputError& error) {
    if (error.place().file != request.file) throw;
    refuse_in_file(request, rows, error, 1);
  }
  try {
    read_back(result, Machine(), request.threads);
  } catch (const InputError& error) {
    refuse_in_file(request, rows, error, 2);  // below a header
  }
}

/// The column that decides the sense of the frame: the azimuth, or the y of a point.
ProposedColumn* column_of_sense(ImportedTable& result) {
  const auto is_it = [](const ProposedColumn& column) {
    return column.column.name.starts_with("azimuth_") || column.column.name.starts_with("measured_y_");
  };
  const auto found = std::find_if(result.columns.begin(), result.columns.end(), is_it);
  return found == result.columns.end() ? nullptr : &*found;
}

void reverse_sense(ProposedColumn& column) {
  const bool azimuth = column.column.name.starts_with("azimuth_");
  const ImportConvention reversed = azimuth ? ImportConvention::clockwise : ImportConvention::reversed;
  column.column.convention = column.column.convention == reversed ? ImportConvention::as_written : reversed;
}

/// Takes away the doubts about commands and points that a good fit proves. An axis that stands still proves nothing.
void drop_proved_doubts(const Machine& machine, const MeasurementTable& table, ImportedTable& result) {
  for (ProposedColumn& column : result.columns) {
    if (column.doubts.empty()) continue;
    const std::string base(without_unit(column.column.name));
    const std::size_t axis = machine.find_axis(base);
    bool proved = base.starts_with("measured_") || base == "range" || base == "azimuth" || base == "elevation";
    if (axis != Machine::npos) {
      const auto [least, most] =
          std::minmax_element(table.readings.poses.axis[axis].begin(), table.readings.poses.axis[axis].end());
      proved = *least < *most;
    }
    if (!proved) continue;
    column.reason += "; the file does not state it, but the fit to the machine proves it";
    column.doubts.clear();
  }
}

double fit_mm(const FrameSense& sense) { return std::min(sense.right_mm, sense.left_mm); }

/// Ways to take a tracker's three numbers as angles and a distance. Which way is up makes no difference to a fit.
std::vector<PolarOrder> polar_orders(const ImportHints& hints) {
  using Units = std::vector<std::string>;
  const Units angles = hints.angle_unit.empty() ? Units{"deg", "gon", "rad"} : Units{hints.angle_unit};
  const Units lengths = hints.length_unit.empty() ? Units{"mm", "m", "inch"} : Units{hints.length_unit};
  std::vector<PolarOrder> orders;
  for (const bool range_first : {false, true}) {
    for (const std::string& angle : angles) {
      for (const std::string& length : lengths) orders.push_back({range_first, angle, length});
    }
  }
  return orders;
}

/// Columns without names that are proposed as coordinates may be azimuth, elevation and range: the machine tells.
/// @param readings  of the coordinates; replaced by those of the better reading
/// @returns whether they are
bool try_polar(const ImportRequest& request, const Machine& machine, ImportedTable& result,
               std::optional<MeasurementTable>& readings) {
  const FrameSense cartesian = frame_sense(machine, *readings);
  if (cartesian.is_proof() || !request.hints.mirrored.empty()) return false;
  double best = fit_mm(cartesian) / 10;
  ImportHints hints = request.hints;
  std::optional<PolarOrder> chosen;
  for (const PolarOrder& order : polar_orders(request.hints)) {
    ImportedTable other;
    other.found = result.found;
    hints.polar = order;
    try {
      propose(request, hints, other);
      const std::optional<MeasurementTable> polar = convert(request, machine, other);
      const FrameSense sense = frame_sense(machine, *polar);
      if (sense.readings < 6 || !(200 * fit_mm(sense) < sense.extent_mm) || !(fit_mm(sense) < best)) continue;
      best = fit_mm(sense);
      chosen = order;
    } catch (const InputError&) {
      continue;  // numbers that cannot be angles or distances
    }
  }
  if (!chosen) return false;
  hints.polar = *chosen;
  propose(request, hints, result);
  readings = convert(request, machine, result);
  result.found.reasons.push_back(
      fmt::format("{}: so the nominal machine fits to {:.3g} mm, and to {:.3g} mm if they are x, y and z",
                  chosen->range_first ? "the last three numbers are range, azimuth and elevation"
                                      : "the last three numbers are azimuth, elevation and range",
                  best, fit_mm(cartesian)));
  return true;
}

/// Lets the commands of the machine decide whether the frame is right-handed, and whether the columns are what they are
/// taken for. @returns whether the mapping changed
bool judge_by_machine(const ImportRequest& request, const Machine& machine, const MeasurementTable& table,
                      ImportedTable& result) {
  ProposedColumn* const column = column_of_sense(result);
  if (column == nullptr) return false;
  const FrameSense sense = frame_sense(machine, table);
  if (!sense.is_right() && !sense.is_left()) return false;
  const double better = std::min(sense.right_mm, sense.left_mm), worse = std::max(sense.right_mm, sense.left_mm);
  const bool is_given = request.hints.clockwise || !request.hints.mirrored.empty();
  if (is_given && sense.is_left()) {
    column->doubts.push_back(fmt::format(
        "the nominal machine fits to {:.3g} mm only with it reversed, and to {:.3g} mm as given", better, worse));
    return false;
  }
  for (ProposedColumn& one : result.columns) one.sense_doubt.clear();
  if (sense.is_left()) {
    reverse_sense(*column);
    result.mapping.columns[static_cast<std::size_t>(column - result.columns.data())] = column->column;
  }
  column->reason +=
      fmt::format("; the nominal machine fits to {:.3g} mm, and to {:.3g} mm with it reversed", better, worse);
  if (sense.is_proof()) drop_proved_doubts(machine, table, result);
  return sense.is_left();
}

}  // namespace

std::vector<std::string> ImportedTable::doubts() const {
  std::vector<std::string> all = found.doubts;
  for (const ProposedColumn& column : columns) {
    for (const std::string& doubt : column.doubts) all.push_back(fmt::format("{}: {}", column.column.name, doubt));
  }
  return all;
}

ImportedTable import_table(const ImportRequest& request) {
  ImportedTable result;
  result.file = request.file;
  result.encoding = request.text.encoding;
  result.encoding_reason = request.text.reason;
  result.packed = request.text.packed;
  result.doubts_accepted = request.accept_doubts;
  if (const std::optional<InstrumentRows> rows = take_instrument(request, result)) {
    if (result.has_readings()) {
      convert(request, *rows, result);
    } else if (request.accept_doubts) {
      throw InputError({.file = request.file, .field = "--accept-uncertain"}, "there are no readings to be written",
                       "no such option");
    }
    return result;
  }
  if (request.mapping) {
    take_mapping(request, result);
  } else {
    take_proposal(request, result);
  }
  const Machine& machine = machine_of_import(request);
  std::optional<MeasurementTable> readings = convert(request, machine, result);
  if (!request.mapping && readings && result.found.layout.header_line == 0) {
    const bool is_polar = try_polar(request, machine, result, readings);
    // An option about angles that the table does not have is refused.
    if (!is_polar && (request.hints.clockwise || request.hints.zenith)) propose(request, request.hints, result);
  }
  if (!request.mapping && readings && judge_by_machine(request, machine, *readings, result)) {
    convert(request, machine, result);
  }
  for (ProposedColumn& column : result.columns) {
    if (!column.sense_doubt.empty()) column.doubts.push_back(std::exchange(column.sense_doubt, std::string()));
  }
  return result;
}

}  // namespace abbe
