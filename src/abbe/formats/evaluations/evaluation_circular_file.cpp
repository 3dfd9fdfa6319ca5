#include "abbe/formats/evaluations/evaluation_circular_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/text/placed_table.h"

namespace abbe {
namespace {

enum CircularColumn : std::size_t { kDirection, kPathAngle, kDeviation, kRadius, kActualX, kActualY, kActualZ };
// A point this near to the centre has no direction, mm.
constexpr double kSmallestRadius = 1e-6;

const std::vector<CsvColumn>& circular_columns() {
  static const std::vector<CsvColumn> all = {
      {"direction", Quantity::dimensionless, true, true},
      {"angle", Quantity::angle, false, false},
      {"deviation", Quantity::length, false, false},
      {"radius", Quantity::length, false, false, CsvColumn::Range::positive},
      {"X", Quantity::length, false, false},
      {"Y", Quantity::length, false, false},
      {"Z", Quantity::length, false, false},
  };
  return all;
}

/// Rows of a path in another order than it was driven (sorted by value, say) are put in the order of their angles; a
/// path driven once or several times, either way, stays as it is.
void put_in_order(CircularReadings& path) {
  std::size_t back = 0, on = 0;
  for (std::size_t i = 1; i < path.count(); ++i) {
    const double step = std::remainder(path.angle[i] - path.angle[i - 1], 2 * std::numbers::pi);
    ++(step < 0 ? back : on);
  }
  // Noise may turn a step of a grid encoder round.
  if (std::min(back, on) <= path.count() / 10) return;
  std::vector<std::size_t> order(path.count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return path.angle[a] < path.angle[b]; });
  const CircularReadings rows = path;
  for (std::size_t i = 0; i < order.size(); ++i) {
    path.angle[i] = rows.angle[order[i]];
    path.radius[i] = rows.radius[order[i]];
  }
}

class CircularReader {
 public:
  CircularReader(PlacedTable table, double nominal_radius) : nominal_radius_(nominal_radius), csv_(std::move(table)) {}

  CircularFile read() {
    const std::size_t coordinates = (has(kActualX) ? 1U : 0U) + (has(kActualY) ? 1U : 0U) + (has(kActualZ) ? 1U : 0U);
    const bool lengths = has(kPathAngle) || has(kDeviation) || has(kRadius);
    if (lengths && coordinates > 0) {
      refuse_columns(has(kActualX)   ? kActualX
                     : has(kActualY) ? kActualY
                                     : kActualZ,
                     "is given together with columns of a ball bar");
    }
    if (coordinates > 0) {
      read_points(coordinates);
    } else {
      read_lengths();
    }
    for (CircularReadings& path : result_.paths) put_in_order(path);
    return std::move(result_);
  }

 private:
  bool has(std::size_t column) const { return csv_.columns[column].present; }

  [[noreturn]] void refuse_columns(std::size_t column, const std::string& problem) const {
    throw InputError(csv_.place(csv_.columns[column].header), problem,
                     "angle_deg with deviation_um or radius_mm, or two of X_mm, Y_mm, Z_mm");
  }
  [[noreturn]] void refuse_row(std::size_t row, const std::string& field, const std::string& problem,
                               const std::string& expected) const {
    throw InputError(csv_.place(row, field), problem, expected);
  }

  /// The path to which a row belongs.
  CircularReadings& path_of(std::size_t row) {
    const CsvValues& direction = csv_.columns[kDirection];
    const std::string& name = direction.names[direction.words[row]];
    if (name == "cw") return result_.paths[static_cast<std::size_t>(CircularDirection::clockwise)];
    if (name == "ccw") return result_.paths[static_cast<std::size_t>(CircularDirection::counterclockwise)];
    refuse_row(row, direction.header, fmt::format("'{}' is not a direction", name.substr(0, 40)),
               "cw (clockwise) or ccw (counter-clockwise)");
  }

  void read_lengths() {
    if (!has(kPathAngle))
      throw InputError(csv_.place("angle"), "missing column", accepted_names("angle", Quantity::angle));
    if (has(kDeviation) && has(kRadius)) refuse_columns(kRadius, "is given together with the deviation");
    if (!has(kDeviation) && !has(kRadius)) {
      throw InputError(csv_.place("deviation"), "missing column", "deviation_um or radius_mm");
    }
    for (std::size_t row = 0; row < csv_.rows; ++row) {
      const double radius =
          has(kRadius) ? csv_.columns[kRadius].numbers[row] : nominal_radius_ + csv_.columns[kDeviation].numbers[row];
      if (radius < kSmallestRadius) {
        const std::size_t column = has(kRadius) ? kRadius : kDeviation;
        refuse_row(row, csv_.columns[column].header, fmt::format("the radius is {:.9g} mm", radius),
                   fmt::format("a radius near the nominal {:.9g} mm", nominal_radius_));
      }
      CircularReadings& path = path_of(row);
      path.angle.push_back(csv_.columns[kPathAngle].numbers[row]);
      path.radius.push_back(radius);
    }
  }

  void read_points(std::size_t coordinates) {
    if (coordinates != 2) {
      refuse_columns(has(kActualX)   ? kActualX
                     : has(kActualY) ? kActualY
                                     : kActualZ,
                     coordinates == 1 ? "is the only coordinate" : "is one of three");
    }
    const std::size_t first = !has(kActualX) ? kActualY : !has(kActualY) ? kActualZ : kActualX;
    const std::size_t second = !has(kActualX) ? kActualZ : !has(kActualY) ? kActualX : kActualY;
    result_.plane = circular_columns()[first].base + circular_columns()[second].base;
    for (CircularReadings& path : result_.paths) path.kind = CircularAngle::measured;
    for (std::size_t row = 0; row < csv_.rows; ++row) {
      const double a = csv_.columns[first].numbers[row], b = csv_.columns[second].numbers[row];
      const double radius = std::hypot(a, b);
      if (radius < kSmallestRadius) {
        refuse_row(row, csv_.columns[first].header, "the point is the centre",
                   "coordinates from the centre of the nominal circle");
      }
      CircularReadings& path = path_of(row);
      path.angle.push_back(std::atan2(b, a));
      path.radius.push_back(radius);
    }
  }

  double nominal_radius_;
  PlacedTable csv_;
  CircularFile result_;
};

}  // namespace

CircularFile read_circular(const std::filesystem::path& path, double nominal_radius, const ColumnMapping& mapping) {
  return read_readable_table(path, circular_columns(), mapping, [&](std::string_view text) {
    return parse_circular(text, path.string(), nominal_radius, mapping);
  });
}

CircularFile parse_circular(std::string_view text, const std::string& file, double nominal_radius,
                            const ColumnMapping& mapping) {
  return CircularReader({text, file, circular_columns(), mapping}, nominal_radius).read();
}

CircularFile parse_circular(const NamedColumns& columns, double nominal_radius) {
  return CircularReader({columns, circular_columns()}, nominal_radius).read();
}

}  // namespace abbe
