#include "abbe/formats/shapes/curve_file.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/ending.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

enum CurveColumn { kX, kY, kZ, kI, kJ, kK, kFeed, kPierce, kBeam, kFirstAxis };

std::vector<CsvColumn> curve_columns(const Machine& machine) {
  using Range = CsvColumn::Range;
  std::vector<CsvColumn> columns = {{"x", Quantity::length},
                                    {"y", Quantity::length},
                                    {"z", Quantity::length},
                                    {"i", Quantity::dimensionless},
                                    {"j", Quantity::dimensionless},
                                    {"k", Quantity::dimensionless},
                                    {"feed_mm_per_min", Quantity::dimensionless, false, false, Range::positive},
                                    {"pierce", Quantity::time, false, false, Range::not_negative},
                                    {"beam", Quantity::dimensionless, false, false}};
  for (const Axis& axis : machine.axes) {
    columns.push_back({axis.name, axis.kind == AxisKind::rotary ? Quantity::angle : Quantity::length, false, false});
  }
  return columns;
}

}  // namespace

Curve parse_curve(std::string_view text, const std::string& file, const Machine& machine) {
  const CsvTable table = read_csv(text, file, curve_columns(machine));
  Curve curve;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    if (table.columns[kFirstAxis + axis].present) curve.indexed.push_back(axis);
  }
  const auto number = [&](std::size_t column, std::size_t row) { return table.columns[column].numbers[row]; };
  for (std::size_t row = 0; row < table.rows; ++row) {
    CurvePoint point;
    point.point = {number(kX, row), number(kY, row), number(kZ, row)};
    const Eigen::Vector3d direction(number(kI, row), number(kJ, row), number(kK, row));
    if (!(direction.norm() > 1e-6)) {
      throw InputError({file, csv_line(text, row), 0, "i, j, k"}, "a direction of length zero",
                       "from the functional point to the source; any length");
    }
    point.direction = direction.normalized();
    if (table.columns[kFeed].present) point.feed = number(kFeed, row) / 60;
    if (table.columns[kPierce].present) point.dwell = number(kPierce, row);
    if (table.columns[kBeam].present) {
      if (number(kBeam, row) != 0 && number(kBeam, row) != 1) {
        throw InputError({file, csv_line(text, row), 0, "beam"}, fmt::format("{}", number(kBeam, row)), "0 or 1");
      }
      point.working = number(kBeam, row) != 0;
    }
    for (const std::size_t axis : curve.indexed) point.indexed.push_back(number(kFirstAxis + axis, row));
    curve.points.push_back(std::move(point));
  }
  return curve;
}

std::string curve_csv(const Curve& curve) {
  assert(curve.indexed.empty());
  std::string text = "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min,beam\n";
  for (const CurvePoint& point : curve.points) {
    assert(point.dwell == 0);
    for (const double value : point.point) text += shortest_text(value) + ",";
    for (const double value : point.direction) text += shortest_text(value) + ",";
    text += shortest_text(60 * point.feed) + (point.working ? ",1\n" : ",0\n");
  }
  return text;
}

Curve read_curve(const std::filesystem::path& path, const Machine& machine) {
  const MappedFile file(path);
  const std::string extension = std::filesystem::path(with_ending(path.string(), file.text())).extension().string();
  if (extension == ".csv") return parse_curve(file.text(), path.string(), machine);
  const bool is_unnamed = path == kStandardInput;
  if (is_unnamed && !can_be_program(file.text())) {
    refuse_contents(path.string(), file.text(), "a curve", {".csv", ".ngc"});
  }
  if (is_unnamed || extension == ".ngc" || extension == ".nc" || extension == ".tap" || extension == ".mpf") {
    return parse_curve_program(file.text(), path.string(), machine);
  }
  throw InputError({.file = path.string()}, "unknown kind of curve file",
                   "a name ending in .csv, or in .ngc, .nc, .tap or .mpf for a program");
}

}  // namespace abbe
