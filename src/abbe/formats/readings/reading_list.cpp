#include "abbe/formats/readings/reading_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::array<std::string_view, 6> kListedTexts = {"setup", "station", "point", "reflector", "item", "target"};
constexpr std::size_t kFirstTarget = 3;
constexpr std::string_view kApproachEnding = "_approach";

bool is_axis_header(const Machine& machine, std::string_view name) {
  const std::size_t underscore = name.rfind('_');
  return machine.find_axis(name) != Machine::npos ||
         (underscore != std::string_view::npos && machine.find_axis(name.substr(0, underscore)) != Machine::npos);
}

/// Names in the header line; a damaged one is left to read_csv().
std::vector<std::string> header_names(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<std::string> names;
  for (std::size_t at = 0; at < text.size();) {
    std::string_view line = csv_next_line(text, at);
    if (csv_is_passed_over(line)) continue;
    bool more = true;
    while (more) {
      std::string_view field;
      std::string unquoted;
      if (!csv_take_field(line, field, unquoted, more)) return {};
      names.emplace_back(csv_trimmed(field));
    }
    break;
  }
  return names;
}

class ReadingListReader {
 public:
  ReadingListReader(std::string_view text, const std::string& file, const Machine& machine)
      : text_(text), file_(file), machine_(machine) {}

  ReadingList read() {
    ReadingList list;
    ColumnMapping mapping;
    for (const std::string& name : header_names(text_)) {
      if (name.ends_with(kApproachEnding)) list.has_approach = true;
      const bool is_text = std::find(kListedTexts.begin(), kListedTexts.end(), name) != kListedTexts.end();
      if (!is_text && (name.ends_with(kApproachEnding) || !is_axis_header(machine_, name))) {
        mapping.ignore.push_back(name);
      }
    }
    std::vector<CsvColumn> columns = axis_columns(machine_);
    const std::size_t first = columns.size();
    for (const std::string_view name : kListedTexts) {
      CsvColumn column{std::string(name), Quantity::dimensionless, true, false, CsvColumn::Range::any};
      column.is_label = true;
      columns.push_back(std::move(column));
    }
    CsvTable table = read_csv(text_, file_, columns, mapping);
    const PoseList poses = take_poses(text_, file_, machine_, table, true);
    if (poses.count() == 0) {
      throw InputError({.file = file_}, "has no reading", "a row for every reading, below the names of the columns");
    }
    const std::size_t target = target_column(table, first, list);
    const std::vector<std::size_t> lines = csv_lines(text_);
    for (std::size_t row = 0; row < table.rows; ++row) {
      const auto label = [&](std::size_t column) {
        return table.columns[column].present ? table.columns[column].labels[row] : std::string();
      };
      ListedReading& reading = list.readings.emplace_back();
      reading.pose = poses.pose(row);
      reading.line = lines[row];
      reading.setup = label(first);
      reading.station = label(first + 1);
      if (reading.station == "-") reading.station.clear();  // of a set-up without stations beside one that has them
      reading.point = label(first + 2);
      reading.what = label(target);
    }
    return list;
  }

 private:
  std::size_t target_column(const CsvTable& table, std::size_t first, ReadingList& list) const {
    std::size_t found = first + kFirstTarget;
    for (std::size_t k = first + kFirstTarget; k < first + kListedTexts.size(); ++k) {
      if (!table.columns[k].present) continue;
      if (!list.what.empty()) {
        throw InputError({file_, 0, 0, table.columns[k].header}, "is given together with " + list.what,
                         "only one of them");
      }
      list.what = table.columns[k].header;
      found = k;
    }
    return found;
  }

  std::string_view text_;
  const std::string& file_;
  const Machine& machine_;
};

}  // namespace

ReadingList parse_reading_list(std::string_view text, const std::string& file, const Machine& machine) {
  return ReadingListReader(text, file, machine).read();
}

ReadingList read_reading_list(const std::filesystem::path& path, const Machine& machine) {
  const MappedFile file(path);
  return parse_reading_list(file.text(), path.string(), machine);
}

ReadingList listed_readings(const PoseList& poses, const std::string& name, const Machine& machine) {
  if (poses.count() == 0) throw InputError({.field = name}, "has no reading", "a row for every reading");
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const std::optional<OutsideTravel> outside = first_outside_travel(machine.axes[i], poses.axis[i]);
    if (!outside) continue;
    throw InputError({.field = name}, fmt::format("reading {}: {}", outside->row + 1, outside->problem),
                     outside->expected);
  }
  ReadingList list;
  for (std::size_t k = 0; k < poses.count(); ++k) list.readings.emplace_back().pose = poses.pose(k);
  return list;
}

std::string reading_words(std::size_t number, const ListedReading& reading) {
  return reading.line == 0 ? fmt::format("reading {}", number)
                           : fmt::format("reading {} (line {})", number, reading.line);
}

}  // namespace abbe
