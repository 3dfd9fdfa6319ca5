#include "abbe/formats/scanner_positioning_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "abbe/formats/csv_reader.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/text_file.h"
#include "abbe/formats/toml_table.h"
#include "abbe/machine/placement.h"

namespace abbe {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// The CSV of all points, given out by the names of their targets; what nobody asks for is an error.
class Targets {
 public:
  Targets(std::string_view text, std::string file) : file_(std::move(file)) {
    const CsvTable csv = read_csv(text, file_,
                                  {{"target", Quantity::dimensionless, true},
                                   {"x", Quantity::length},
                                   {"y", Quantity::length},
                                   {"z", Quantity::length}});
    names_ = csv.columns[0].names;
    points_.resize(names_.size());
    asked_.resize(names_.size());
    for (std::size_t row = 0; row < csv.rows; ++row) {
      points_[csv.columns[0].words[row]].emplace_back(csv.columns[1].numbers[row], csv.columns[2].numbers[row],
                                                      csv.columns[3].numbers[row]);
    }
  }

  Points take(const std::string& name) {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) {
      throw InputError({.file = file_, .field = "target"}, "there are no points of '" + name + "'",
                       "rows with this target, as the positioning file names it");
    }
    const auto at = static_cast<std::size_t>(found - names_.begin());
    asked_[at] = true;
    return points_[at];
  }

  void finish() const {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (asked_[i]) continue;
      throw InputError({.file = file_, .field = "target"}, "nothing is said about '" + names_[i].substr(0, 40) + "'",
                       "targets that the positioning file names");
    }
  }

 private:
  std::string file_;
  std::vector<std::string> names_;
  std::vector<Points> points_;
  std::vector<bool> asked_;
};

Eigen::Vector3d triple(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

Shape feature_of(TomlTable& table) {
  Shape shape;
  constexpr ShapeKind kKinds[] = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere};
  shape.kind = kKinds[table.word("kind", {"plane", "cylinder", "sphere"})];
  shape.point = triple(table.numbers("point", Quantity::length, 3));
  if (shape.kind != ShapeKind::sphere) {
    shape.direction = triple(table.numbers("direction", Quantity::dimensionless, 3));
    if (!(shape.direction.norm() > 1e-9)) {
      table.fail("direction", "a direction of length zero", "normal of a plane, axis of a cylinder");
    }
    shape.direction.normalize();
  }
  if (shape.kind != ShapeKind::plane) {
    shape.radius = table.number("radius", Quantity::length);
    if (!(shape.radius > 0)) table.fail_quantity("radius", Quantity::length, "not above zero", "a radius");
  }
  return shape;
}

WorkpieceScan workpiece_of(TomlTable table, Targets& targets) {
  WorkpieceScan workpiece;
  workpiece.noise = table.size_or("noise", Quantity::length, 0);
  if (table.has("part")) {
    workpiece.part = table.text("part");
    workpiece.scan = table.text("scan");
    table.finish();
    return workpiece;
  }
  workpiece.start.translation = triple(table.numbers("start_translation", Quantity::length, 3));
  workpiece.start.rotation = rotation_xyz(triple(table.numbers("start_angles", Quantity::angle, 3)));
  Points points;
  for (TomlTable& feature : table.tables("feature")) {
    const Points seen = targets.take(feature.text("target"));
    points.insert(points.end(), seen.begin(), seen.end());
    workpiece.labels.insert(workpiece.labels.end(), seen.size(), workpiece.features.size());
    workpiece.features.push_back(feature_of(feature));
    feature.finish();
  }
  if (workpiece.features.empty()) {
    table.fail("feature", "there is none", "[[workpiece.feature]] tables, or part and scan");
  }
  table.finish();
  workpiece.points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) workpiece.points.col(static_cast<Eigen::Index>(i)) = points[i];
  return workpiece;
}

ScannerPositioningFile positioning_of(TomlTable root, Targets targets) {
  ScannerPositioningFile result;
  PositioningScans& scans = result.scans;
  scans.along_x = targets.take(root.text_or("along_x", "X"));
  scans.along_y = targets.take(root.text_or("along_y", "Y"));
  for (const std::string& name : root.texts("circles")) scans.circles.push_back(targets.take(name));
  scans.turned_positively = root.word_or("turned", 0, {"positively", "negatively"}) == 0;
  scans.sphere = targets.take(root.text_or("sphere", "sphere"));
  scans.sphere_radius = root.size_or("sphere_radius", Quantity::length, 0);
  scans.sphere_height = root.number("sphere_height", Quantity::length);
  if (const auto moved = root.optional_numbers("moved_since", Quantity::length, 3)) scans.moved_since = triple(*moved);
  if (std::optional<TomlTable> noise = root.optional_table("noise")) {
    scans.target_noise = noise->size_or("target", Quantity::length, 0);
    scans.sphere_noise = noise->size_or("sphere", Quantity::length, 0);
    scans.height_noise = noise->size_or("height", Quantity::length, 0);
    noise->finish();
  }
  if (std::optional<TomlTable> workpiece = root.optional_table("workpiece")) {
    result.workpiece = workpiece_of(*workpiece, targets);
  }
  root.finish();
  targets.finish();
  return result;
}

}  // namespace

ScannerPositioningFile read_scanner_positioning(const std::filesystem::path& path) {
  TomlTable root = TomlTable::parse(read_text_file(path), path.string());
  const std::filesystem::path points = root.file("points", path.parent_path(), "a CSV file of points");
  const MappedFile file(points);
  ScannerPositioningFile result = positioning_of(root, Targets(file.text(), points.string()));
  if (!result.workpiece || result.workpiece->part.empty()) return result;
  for (std::filesystem::path* named : {&result.workpiece->part, &result.workpiece->scan}) {
    *named = path.parent_path() / *named;
  }
  return result;
}

ScannerPositioningFile parse_scanner_positioning(const std::string& text, const std::string& file,
                                                 std::string_view points, const std::string& points_file) {
  TomlTable root = TomlTable::parse(text, file);
  root.text("points");
  return positioning_of(root, Targets(points, points_file));
}

std::string target_points_csv(const std::vector<TargetPoints>& targets) {
  std::string text = "target,x_mm,y_mm,z_mm\n";
  for (const TargetPoints& target : targets) {
    for (const Eigen::Vector3d& p : target.points) {
      fmt::format_to(std::back_inserter(text), "{},{:.6f},{:.6f},{:.6f}\n", csv_field(target.target), p.x(), p.y(),
                     p.z());
    }
  }
  return text;
}

}  // namespace abbe
