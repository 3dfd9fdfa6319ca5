#include "abbe/formats/readings/scan_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>
#include <vector>

#include "abbe/formats/files/file_extension.h"
#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/error_fields.h"
#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/text/csv_rows.h"
#include "abbe/formats/text/fixed_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

/// One run of lines on its way from text to text; its memory serves the next run.
class ScanRun {
 public:
  void pass(const CsvRows& rows, std::size_t from, std::size_t to, const Machine& machine, const PointScan& scan,
            ScanFormat format, const ScanOptions& options) {
    summary = {};
    text.clear();
    refusal = rows.read(from, to, table_);
    if (refusal) return;
    const std::size_t axes = machine.axes.size();
    if (options.check_travel) {
      for (std::size_t i = 0; i < axes && !refusal; ++i) check_travel(rows, from, machine.axes[i], table_.columns[i]);
      if (refusal) return;
    }
    summary.readings = table_.rows;
    for (std::vector<double>* coordinate : {&x_, &y_, &z_}) coordinate->resize(table_.rows);
    covered_.assign(table_.rows, 1);
    axis_.resize(axes);
    for (std::size_t i = 0; i < axes; ++i) axis_[i] = table_.columns[i].numbers.data();
    const std::vector<double>& indication = table_.columns[axes].numbers;
    scan.points({axis_, table_.rows}, indication.data(), {x_.data(), y_.data(), z_.data()}, covered_.data());
    keep(indication, options);
    if (summary.points > 0) box();
    if (format == ScanFormat::csv) {
      csv(options.decimals);
    } else {
      ply();
    }
  }

  ScanSummary summary;
  std::string text;
  std::optional<TextRefusal> refusal;

 private:
  void check_travel(const CsvRows& rows, std::size_t from, const Axis& axis, const CsvValues& values) {
    const auto outside = first_outside_travel(axis, values.numbers);
    if (outside)
      refusal = TextRefusal{rows.row_offset(from, outside->row), values.header, outside->problem, outside->expected};
  }

  /// Closes the gaps of the points that do not count.
  void keep(const std::vector<double>& indication, const ScanOptions& options) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < table_.rows; ++k) {
      if (!(indication[k] >= options.lowest_indication && indication[k] <= options.highest_indication)) {
        ++summary.out_of_range;
        continue;
      }
      if (covered_[k] == 0) {
        ++summary.not_covered;
        continue;
      }
      x_[kept] = x_[k];
      y_[kept] = y_[k];
      z_[kept] = z_[k];
      ++kept;
    }
    summary.points = kept;
  }

  void box() {
    const std::array<const std::vector<double>*, 3> coordinates = {&x_, &y_, &z_};
    const auto count = static_cast<std::ptrdiff_t>(summary.points);
    for (int i = 0; i < 3; ++i) {
      const std::vector<double>& values = *coordinates[static_cast<std::size_t>(i)];
      const auto [low, high] = std::minmax_element(values.begin(), values.begin() + count);
      summary.lowest[i] = *low;
      summary.highest[i] = *high;
    }
  }

  void csv(int decimals) {
    text.resize(summary.points * 3 * kLongestFixedText);
    char* at = text.data();
    for (std::size_t k = 0; k < summary.points; ++k) {
      at = write_fixed(x_[k], decimals, at);
      *at++ = ',';
      at = write_fixed(y_[k], decimals, at);
      *at++ = ',';
      at = write_fixed(z_[k], decimals, at);
      *at++ = '\n';
    }
    text.resize(static_cast<std::size_t>(at - text.data()));
  }

  void ply() {
    static_assert(std::endian::native == std::endian::little);
    text.resize(summary.points * 3 * sizeof(double));
    char* at = text.data();
    for (std::size_t k = 0; k < summary.points; ++k) {
      const std::array<double, 3> point = {x_[k], y_[k], z_[k]};
      std::memcpy(at, point.data(), sizeof(point));
      at += sizeof(point);
    }
  }

  CsvTable table_;
  std::vector<const double*> axis_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint8_t> covered_;
};

void add(const ScanSummary& part, ScanSummary& sum) {
  if (part.points > 0) {
    sum.lowest = sum.points > 0 ? Eigen::Vector3d(sum.lowest.cwiseMin(part.lowest)) : part.lowest;
    sum.highest = sum.points > 0 ? Eigen::Vector3d(sum.highest.cwiseMax(part.highest)) : part.highest;
  }
  sum.readings += part.readings;
  sum.points += part.points;
  sum.out_of_range += part.out_of_range;
  sum.not_covered += part.not_covered;
}

}  // namespace

ScanFormat scan_format(const std::filesystem::path& path) {
  const std::string extension = file_extension(path);
  if (extension == ".csv") return ScanFormat::csv;
  if (extension == ".ply") return ScanFormat::ply;
  throw InputError({path.string(), 0, 0, ""}, "unknown kind of file for points", "a name ending in .csv or .ply");
}

std::string scan_ply_header(std::size_t points) {
  // The number of points is known at the end: blanks behind a comment keep the length.
  const std::string number = std::to_string(points);
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment unit mm\ncomment points in the order of the readings{}\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\nend_header\n",
      std::string(20 - number.size(), ' '), number);
}

ScanSummary scan_points(std::string_view text, const std::string& file, const Machine& machine, const PointScan& scan,
                        ScanFormat format, const ScanOptions& options,
                        const std::function<void(std::string_view)>& write,
                        const std::function<void(std::size_t)>& passed) {
  std::vector<CsvColumn> wanted = axis_columns(machine);
  wanted.push_back({"indication", Quantity::length});
  const CsvRows rows(text, file, wanted, options.mapping);
  text = rows.text();
  ScanSummary sum;
  const int threads = options.threads > 0 ? options.threads : default_thread_count();
  // Two runs per thread: one that takes longer does not keep the others waiting. Two sets of runs: while one is
  // computed the other is written, as one more piece of work.
  std::array<std::vector<ScanRun>, 2> sets;
  for (std::vector<ScanRun>& runs : sets) runs.resize(2 * static_cast<std::size_t>(threads));
  std::array<std::size_t, 2> used{};
  std::vector<std::pair<std::size_t, std::size_t>> places;
  const auto write_set = [&](std::size_t set) {
    for (std::size_t i = 0; i < used[set]; ++i) write(sets[set][i].text);
  };
  if (format == ScanFormat::csv) write("x_mm,y_mm,z_mm\n");
  std::size_t now = 0;
  for (std::size_t at = rows.first(); at < text.size(); now = 1 - now) {
    std::vector<ScanRun>& runs = sets[now];
    places.clear();
    while (at < text.size() && places.size() < runs.size()) {
      const std::size_t end = text_block_end(text, at);
      places.emplace_back(at, end);
      at = end;
    }
    for_each_block(places.size() + 1, threads, [&](std::size_t i) {
      if (i == 0) {
        write_set(1 - now);
      } else {
        runs[i - 1].pass(rows, places[i - 1].first, places[i - 1].second, machine, scan, format, options);
      }
    });
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (runs[i].refusal) throw_refusal(text, file, *runs[i].refusal);
      add(runs[i].summary, sum);
    }
    used[now] = places.size();
    if (passed) passed(at);
    if (options.progress) options.progress(at, text.size());
  }
  write_set(1 - now);
  if (sum.readings == 0) throw InputError({file, 0, 0, ""}, "there are no rows below the header", "at least one row");
  return sum;
}

ScanSummary scan_points(const std::filesystem::path& readings, const Machine& machine, const PointScan& scan,
                        const std::filesystem::path& output, const ScanOptions& options) {
  const ScanFormat format = scan_format(output);
  MappedFile file(readings);
  StreamedFile points(output);
  if (format == ScanFormat::ply) points.append(scan_ply_header(0));
  ScanSummary summary = scan_points(
      file.text(), readings.string(), machine, scan, format, options,
      [&](std::string_view text) { points.append(text); }, [&](std::size_t end) { file.forget(end); });
  if (format == ScanFormat::ply) points.overwrite(0, scan_ply_header(summary.points));
  points.commit();
  return summary;
}

}  // namespace abbe
