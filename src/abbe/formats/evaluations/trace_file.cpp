#include "abbe/formats/evaluations/trace_file.h"

#include <fmt/format.h>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

TraceFile parse_trace(std::string_view text, const std::string& file, const Machine& machine) {
  std::vector<CsvColumn> columns = axis_columns(machine);
  const std::size_t time = columns.size();
  columns.push_back({"time", Quantity::time, false, false, CsvColumn::Range::any});
  // What traces and the commands that `abbe path` writes have beside the axes.
  for (const char* const name : {"line", "step", "point", "region", "beam", "feed_mm_per_min"}) {
    columns.push_back({name, Quantity::dimensionless, false, false, CsvColumn::Range::any});
  }
  columns.push_back({"length", Quantity::length, false, false, CsvColumn::Range::any});
  columns.push_back({"dwell", Quantity::time, false, false, CsvColumn::Range::any});
  CsvTable table = read_csv(text, file, columns);
  if (table.rows < 2) {
    throw InputError({file, 0, 0, ""}, fmt::format("{} sample{}", table.rows, table.rows == 1 ? "" : "s"),
                     "two or more: one row for each servo cycle or so");
  }
  TraceFile trace;
  trace.commands = take_poses(text, file, machine, table, false);
  trace.lines = csv_lines(text);
  if (table.columns[time].present) {
    trace.time_s = std::move(table.columns[time].numbers);
    for (std::size_t row = 1; row < trace.time_s.size(); ++row) {
      if (trace.time_s[row] >= trace.time_s[row - 1]) continue;
      throw InputError({file, csv_line(text, row), 0, table.columns[time].header},
                       fmt::format("{:.9g} s follows {:.9g} s", trace.time_s[row], trace.time_s[row - 1]),
                       "rows in chronological order");
    }
  }
  return trace;
}

TraceFile read_trace(const std::filesystem::path& path, const Machine& machine) {
  const MappedFile file(path);
  return parse_trace(file.text(), path.string(), machine);
}

}  // namespace abbe
