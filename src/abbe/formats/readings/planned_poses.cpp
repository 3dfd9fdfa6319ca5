#include "abbe/formats/readings/planned_poses.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

class PlannedPosesReader {
 public:
  PlannedPosesReader(std::string_view text, const std::string& file, const Machine& machine, const Setup& setup,
                     const ChannelUse& channels)
      : text_(text), file_(file), machine_(machine), setup_(setup), channels_(channels) {}

  PlannedPoses read() {
    std::vector<CsvColumn> columns = axis_columns(machine_);
    const std::size_t setup = columns.size(), station = setup + 1, target = setup + 2;
    const std::string one = setup_.device->target_word();
    for (const std::string& name : {std::string("setup"), std::string("station"), one, std::string("target")})
      columns.push_back({name, Quantity::dimensionless, true, false});
    const std::size_t states = add_state_columns(machine_, columns);
    const std::size_t time = columns.size();
    columns.push_back({"time", Quantity::time, false, false, CsvColumn::Range::any});
    table_ = read_csv(text_, file_, columns);
    PoseList all = take_poses(text_, file_, machine_, table_, true);
    take_states(text_, file_, machine_, table_, states, time, {}, all);
    const std::size_t named = table_.columns[target].present ? target : target + 1;
    if (table_.columns[target].present && table_.columns[target + 1].present) {
      throw InputError({file_, 0, 0, "target"}, "is given together with " + table_.columns[target].header,
                       "only one of them");
    }

    const std::vector<std::string> stations = setup_.device->station_names(), targets = setup_.device->target_names();

    PlannedPoses result;
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < table_.rows; ++row) {
      if (table_.columns[setup].present && name(setup, row) != setup_.name) continue;
      rows.push_back(row);
      result.poses.append(all.pose(row));
      if (table_.columns[time].present) result.time_s.push_back(table_.columns[time].numbers[row]);
      result.poses.state.resize(all.state.size());
      for (std::size_t j = 0; j < all.state.size(); ++j) {
        if (!all.state[j].empty()) result.poses.state[j].push_back(all.state[j][row]);
      }
      if (!stations.empty()) {
        if (!table_.columns[station].present && stations.size() > 1) fail(row, "station", "is missing", stations);
        result.station.push_back(table_.columns[station].present ? find(station, row, stations) : 0);
      }
      if (table_.columns[named].present) result.target.push_back(find(named, row, targets));
    }
    if (result.poses.count() == 0) {
      throw InputError({.file = file_}, fmt::format("has no pose for the set-up '{}'", setup_.name),
                       "rows with its name in the column setup, or no such column");
    }
    if (channels_.from == nullptr) return result;
    const ReadingRows places{file_, table_.columns[time].header,
                             [&](std::size_t pose) { return csv_line(text_, rows[pose]); }};
    channels_.from->give(machine_, result.time_s, places, result.poses, channels_.starts);
    return result;
  }

 private:
  const std::string& name(std::size_t column, std::size_t row) const {
    return table_.columns[column].names[table_.columns[column].words[row]];
  }

  [[noreturn]] void fail(std::size_t row, const std::string& field, const std::string& problem,
                         const std::vector<std::string>& known) const {
    throw InputError({file_, csv_line(text_, row), 0, field}, problem,
                     fmt::format("one of {}", fmt::join(known, ", ")));
  }

  std::size_t find(std::size_t column, std::size_t row, const std::vector<std::string>& known) const {
    const auto found = std::find(known.begin(), known.end(), name(column, row));
    if (found == known.end()) {
      fail(row, table_.columns[column].header,
           fmt::format("'{}' is not in the set-up '{}'", name(column, row), setup_.name), known);
    }
    return static_cast<std::size_t>(found - known.begin());
  }

  std::string_view text_;
  const std::string& file_;
  const Machine& machine_;
  const Setup& setup_;
  const ChannelUse& channels_;
  CsvTable table_;
};

}  // namespace

PlannedPoses parse_planned_poses(std::string_view text, const std::string& file, const Machine& machine,
                                 const Setup& setup, const ChannelUse& channels) {
  return PlannedPosesReader(text, file, machine, setup, channels).read();
}

PlannedPoses read_planned_poses(const std::filesystem::path& path, const Machine& machine, const Setup& setup,
                                const ChannelUse& channels) {
  const MappedFile file(path);
  return parse_planned_poses(file.text(), path.string(), machine, setup, channels);
}

}  // namespace abbe
