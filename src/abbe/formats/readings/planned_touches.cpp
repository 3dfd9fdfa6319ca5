#include "abbe/formats/readings/planned_touches.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/errors/poses.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/nc/measuring_dialect.h"
#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

constexpr std::string_view kLogWords = "XYZABCUVW";
constexpr double kSameAsPlanned = 1e-4;  // mm, degrees

std::string position_headers(const Machine& machine) {
  std::string text;
  for (const Axis& axis : machine.axes) text += fmt::format("{}_{},", axis.name, position_suffix(axis));
  return text;
}

bool has_items(const std::vector<PlannedTouch>& touches) {
  return std::any_of(touches.begin(), touches.end(), [](const PlannedTouch& touch) { return !touch.item.empty(); });
}

/// Lines of a log as positions of the axes, mm or rad.
class TouchLogReader {
 public:
  TouchLogReader(const Machine& machine, std::string_view log, const std::string& file,
                 const std::map<std::string, std::string>& words)
      : machine_(machine), lines_(log), file_(file) {
    MeasuringProgramOptions options;
    options.words = words;
    for (const Axis& axis : machine.axes)
      places_.push_back(kLogWords.find(upper_case(measuring_word(axis, options)[0])));
  }

  /// @returns false at the end
  bool next(std::vector<double>& pose) {
    if (!lines_.next()) return false;
    const std::vector<std::string_view> fields = instrument_words(lines_.text());
    if (fields.size() != kLogWords.size()) {
      throw InputError({.file = file_, .line = lines_.number()},
                       "the line has " + counted(fields.size(), "field", "fields"),
                       "9 numbers: X Y Z A B C U V W, as LinuxCNC logs touches");
    }
    pose.resize(places_.size());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      pose[i] = instrument_number(fields[places_[i]], file_, lines_.number(), std::string(1, kLogWords[places_[i]]),
                                  "a number in mm or degrees") *
                position_unit(machine_.axes[i]);
    }
    return true;
  }

  std::size_t line() const { return lines_.number(); }

 private:
  const Machine& machine_;
  InstrumentLines lines_;
  const std::string& file_;
  std::vector<std::size_t> places_;
};

/// What keeps a logged position from being that of a touch, or nothing.
std::string difference(const Machine& machine, const PlannedTouch& touch, const std::vector<double>& pose) {
  double squared = 0;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const Axis& axis = machine.axes[i];
    const double off = (pose[i] - touch.pose[i]) / position_unit(axis);
    if (axis.kind == AxisKind::rotary && std::abs(off) > kSameAsPlanned) {
      return fmt::format("axis {} is {:.4f} degrees from where it should be", axis.name, off);
    }
    if (axis.kind == AxisKind::linear) squared += off * off;
  }
  if (std::sqrt(squared) <= touch.within + kSameAsPlanned) return "";
  return fmt::format("it is {:.3f} mm from where the probe should touch", std::sqrt(squared));
}

}  // namespace

std::string planned_touches_csv(const Machine& machine, const std::vector<PlannedTouch>& touches) {
  const bool items = has_items(touches);
  std::string text = "# touches in the order of the program: abbe import LOG --touches THIS_FILE\n" +
                     position_headers(machine) + (items ? "item," : "") +
                     "approach_x_mm,approach_y_mm,approach_z_mm,within_mm,point\n";
  for (const PlannedTouch& touch : touches) {
    for (std::size_t i = 0; i < touch.pose.size(); ++i) {
      text += fmt::format("{:.6f},", touch.pose[i] / position_unit(machine.axes[i]));
    }
    if (items) text += csv_field(touch.item) + ",";
    for (const double component : touch.approach) text += shortest_text(component) + ",";
    text += shortest_text(touch.within) + "," + csv_field(touch.point) + "\n";
  }
  return text;
}

std::vector<PlannedTouch> parse_planned_touches(std::string_view text, const std::string& file,
                                                const Machine& machine) {
  std::vector<CsvColumn> columns = axis_columns(machine);
  const std::size_t first = columns.size();
  for (const char* name : {"approach_x", "approach_y", "approach_z"}) columns.push_back({name, Quantity::length});
  columns.push_back({"within", Quantity::length, false, true, CsvColumn::Range::not_negative});
  for (const char* name : {"item", "point"}) {
    CsvColumn label{name, Quantity::dimensionless, true, false, CsvColumn::Range::any};
    label.is_label = true;
    columns.push_back(label);
  }
  CsvTable table = read_csv(text, file, columns);
  const PoseList poses = take_poses(text, file, machine, table, true);
  std::vector<PlannedTouch> touches(table.rows);
  for (std::size_t row = 0; row < table.rows; ++row) {
    PlannedTouch& touch = touches[row];
    touch.pose = poses.pose(row);
    for (std::size_t k = 0; k < 3; ++k) {
      touch.approach[static_cast<Eigen::Index>(k)] = table.columns[first + k].numbers[row];
    }
    touch.within = table.columns[first + 3].numbers[row];
    if (table.columns[first + 4].present) touch.item = table.columns[first + 4].labels[row];
    if (table.columns[first + 5].present) touch.point = table.columns[first + 5].labels[row];
  }
  return touches;
}

std::vector<PlannedTouch> read_planned_touches(const std::filesystem::path& path, const Machine& machine) {
  const MappedFile file(path);
  return parse_planned_touches(file.text(), path.string(), machine);
}

std::string probed_touches_csv(const Machine& machine, const std::vector<PlannedTouch>& touches,
                               const std::string& touches_file, std::string_view log, const std::string& log_file,
                               const std::map<std::string, std::string>& words) {
  const bool items = has_items(touches);
  std::string text = position_headers(machine) + (items ? "item," : "") +
                     "approach_x_mm,approach_y_mm,approach_z_mm,travel_mm,point\n";
  TouchLogReader reader(machine, log, log_file, words);
  std::size_t count = 0;
  for (std::vector<double> pose; reader.next(pose); ++count) {
    const InputError::Place place{.file = log_file, .line = reader.line()};
    if (count == touches.size()) {
      throw InputError(place, "there are more touches than the program plans",
                       fmt::format("{} lines, as {} has rows", touches.size(), touches_file));
    }
    const PlannedTouch& touch = touches[count];
    const std::string problem = difference(machine, touch, pose);
    if (!problem.empty()) {
      throw InputError(place, problem,
                       fmt::format("touch {} of {}, in the order of the program", count + 1, touches_file));
    }
    for (std::size_t i = 0; i < pose.size(); ++i) {
      text += fmt::format("{:.6f},", pose[i] / position_unit(machine.axes[i]));
    }
    if (items) text += csv_field(touch.item) + ",";
    for (const double component : touch.approach) text += shortest_text(component) + ",";
    text += "0," + csv_field(touch.point) + "\n";
  }
  if (count < touches.size()) {
    throw InputError({.file = log_file},
                     counted(touches.size() - count, "touch is", "touches are") + " missing at its end",
                     fmt::format("{} lines, as {} has rows", touches.size(), touches_file));
  }
  return text;
}

}  // namespace abbe
