#include "abbe/formats/readings/scanner_positioning_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/toml_table.h"
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

void require_features(const ScannerPositioningFile& file, const std::vector<std::string>& names) {
  const std::size_t features = file.workpiece ? file.workpiece->features.size() : 0;
  if (file.workpiece && !file.workpiece->part.empty())
    throw std::invalid_argument("a workpiece on a mesh is not written");
  if (features == names.size()) return;
  throw std::invalid_argument(fmt::format("{} features of a workpiece and {} names", features, names.size()));
}

std::string circle_name(std::size_t i) { return fmt::format("circle {}", i + 1); }

std::string triple_text(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", shortest_text(v.x()), shortest_text(v.y()), shortest_text(v.z()));
}

}  // namespace

ScannerPositioningFile read_scanner_positioning(const std::filesystem::path& path) {
  TomlTable root = TomlTable::parse(read_file_of_kind(path, ".positioning.toml"), path.string());
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

std::string scanner_positioning_text(const ScannerPositioningFile& file, const std::string& points_file,
                                     const std::vector<std::string>& names) {
  require_features(file, names);
  const PositioningScans& scans = file.scans;
  std::string circles;
  for (std::size_t i = 0; i < scans.circles.size(); ++i) {
    circles += fmt::format("{}\"{}\"", i > 0 ? ", " : "", circle_name(i));
  }
  std::string text = fmt::format(
      "points = {}         # target, x_mm, y_mm, z_mm in the scanner's frame\n"
      "along_x = \"X\"                 # while X carries it in its positive sense\n"
      "along_y = \"Y\"\n"
      "circles = [{}]   # while the table turns, in order\n"
      "turned = \"{}\"         # about the table's Z by the right-hand rule: positively or negatively\n"
      "sphere = \"sphere\"\n",
      toml_string(points_file), circles, scans.turned_positively ? "positively" : "negatively");
  if (scans.sphere_radius > 0) text += fmt::format("sphere_radius_mm = {}\n", shortest_text(scans.sphere_radius));
  text += fmt::format("sphere_height_mm = {}   # of its centre above the table\n", shortest_text(scans.sphere_height));
  text += fmt::format("moved_since_mm = {}   # by X and Y, between the sphere and the workpiece\n",
                      triple_text(scans.moved_since));
  text += fmt::format("noise = {{ target_um = {}, sphere_um = {}, height_um = {} }}\n",
                      shortest_text(1e3 * scans.target_noise), shortest_text(1e3 * scans.sphere_noise),
                      shortest_text(1e3 * scans.height_noise));
  if (!file.workpiece) return text;
  const WorkpieceScan& workpiece = *file.workpiece;
  text += fmt::format("\n[workpiece]\nnoise_um = {}\n", shortest_text(1e3 * workpiece.noise));
  text += fmt::format("start_translation_mm = {}   # workpiece from scanner, roughly\n",
                      triple_text(workpiece.start.translation));
  const Eigen::Vector3d angles = angles_xyz(workpiece.start.rotation);
  text += toml_angles("start_angles", {angles.x(), angles.y(), angles.z()});  // Rx Ry Rz
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Shape& shape = workpiece.features[i];
    text += fmt::format("\n[[workpiece.feature]]\ntarget = {}\nkind = \"{}\"\npoint_mm = {}\n", toml_string(names[i]),
                        shape_name(shape.kind), triple_text(shape.point));
    if (shape.kind != ShapeKind::sphere) text += fmt::format("direction = {}\n", triple_text(shape.direction));
    if (shape.kind != ShapeKind::plane) text += fmt::format("radius_mm = {}\n", shortest_text(shape.radius));
  }
  return text;
}

std::vector<TargetPoints> positioning_targets(const ScannerPositioningFile& file,
                                              const std::vector<std::string>& names) {
  require_features(file, names);
  std::vector<TargetPoints> targets = {{"X", file.scans.along_x}, {"Y", file.scans.along_y}};
  for (std::size_t i = 0; i < file.scans.circles.size(); ++i) {
    targets.push_back({circle_name(i), file.scans.circles[i]});
  }
  targets.push_back({"sphere", file.scans.sphere});
  for (std::size_t f = 0; f < names.size(); ++f) {
    targets.push_back({names[f], {}});
    for (std::size_t i = 0; i < file.workpiece->labels.size(); ++i) {
      if (file.workpiece->labels[i] != f) continue;
      targets.back().points.emplace_back(file.workpiece->points.col(static_cast<Eigen::Index>(i)));
    }
  }
  return targets;
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
