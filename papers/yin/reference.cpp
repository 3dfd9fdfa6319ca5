#include "yin/reference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/vector_json.h"
#include "abbe/verify/parts/contour_error.h"
#include "shared_file.h"

namespace abbe {
namespace {

nlohmann::json reference(const char* name) {
  return nlohmann::json::parse(read_text_file(shared_file(std::string("golden/yin/") + name)));
}

std::vector<Eigen::Vector3d> scan(const char* name, std::vector<std::size_t>* labels = nullptr) {
  const std::string path = shared_file(std::string("golden/yin/positioning_exact_") + name + ".csv").string();
  const MappedFile file(path);
  std::vector<CsvColumn> columns = {
      {"x_MCS", Quantity::length}, {"y_MCS", Quantity::length}, {"z_MCS", Quantity::length}};
  if (labels != nullptr) columns.push_back({"surface", Quantity::dimensionless});
  const CsvTable table = read_csv(file.text(), path, columns);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < table.rows; ++i) {
    points.emplace_back(table.columns[0].numbers[i], table.columns[1].numbers[i], table.columns[2].numbers[i]);
    if (labels == nullptr) continue;
    labels->push_back(static_cast<std::size_t>(std::clamp(table.columns[3].numbers[i], 0.0, 2.0)));
  }
  return points;
}

Eigen::Matrix3Xd matrix_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix3Xd matrix(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = points[i];
  return matrix;
}

RigidTransform transform_of(const nlohmann::json& rows) {
  RigidTransform t;
  for (int i = 0; i < 3; ++i) {
    const nlohmann::json& row = rows[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) t.rotation(i, k) = row[static_cast<std::size_t>(k)];
    t.translation[i] = row[3];
  }
  return t;
}

std::array<double, SwingHeadLinkage::kCount> parameters_of(const nlohmann::json& json) {
  std::array<double, SwingHeadLinkage::kCount> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = json[linkage_name(i)];
  return values;
}

}  // namespace

SwingHeadLinkage yin_linkage() { return {240.745, 209.476, -0.265, -0.145, {-197.236, 25.306, -528.996}}; }

YinLinkageReference yin_linkage_reference(LinkageConvention convention) {
  const nlohmann::json json = reference("linkage_five_steps.json");
  const nlohmann::json& own = json[convention == LinkageConvention::table_moves ? "U" : "P"];
  const nlohmann::json &two = own["raw"]["step2"], &three = own["raw"]["step3"], &four = own["raw"]["step4"],
                       &five = own["raw"]["step5"];
  YinLinkageReference result;
  LinkageReadings& r = result.readings;
  r.convention = convention;
  r.exit_z = two["z1"];
  r.focus_z = two["z"].get<std::vector<double>>();
  r.focus_width = two["width"].get<std::vector<double>>();
  r.exit_to_axis = two["d"];
  r.board_thickness = two["h"];
  r.height_first = three["height_l1"];
  r.height_second = three["height_l2"];
  r.x_first = four["x1"];
  r.x_second = four["x2"];
  r.line3_x = four["l3_x"];
  r.line5_x = four["l5_x"];
  r.line4_y = four["l4_y"];
  r.line6_y = four["l6_y"];
  r.circle_x = five["x3"];
  r.circle_y = five["y3"];
  r.circle_z = five["z3"];
  result.recovered = parameters_of(own["recovered"]);
  result.printed = parameters_of(own["printed"]);
  result.waist = 2 * json["assumptions"]["w0"].get<double>();
  result.divergence = result.waist / json["assumptions"]["zR"].get<double>();
  return result;
}

YinPositioningReference yin_positioning_reference() {
  const nlohmann::json json = reference("positioning.json");
  const nlohmann::json &exact = json["exact"], &setup = json["setup"];
  YinPositioningReference result;
  PositioningScans& scans = result.scans;
  scans.along_x = scan("PX");
  scans.along_y = scan("PY");
  scans.circles = {scan("C1"), scan("C2")};
  scans.sphere = scan("S");
  scans.sphere_height = setup["ZP"];
  scans.moved_since = vector_of(setup["DEL"]);
  result.surface = matrix_of(scan("M", &result.labels));
  result.start = transform_of(setup["initial_DMW"]);
  result.table_from_scanner = transform_of(exact["DMB"]);
  result.workpiece_from_scanner = transform_of(exact["DMW"]);
  result.workpiece_from_table = transform_of(exact["DBW"]);
  result.x_direction = vector_of(exact["nx"]);
  result.y_direction = vector_of(exact["ny"]);
  result.axis_direction = vector_of(exact["L"]);
  result.sphere_centre = vector_of(exact["os"]);
  result.on_axis = vector_of(exact["osc"]);
  result.on_axis_turned = vector_of(exact["oR"]);
  for (std::size_t i = 0; i < 6; ++i) result.parameters[i] = exact["par"][i];
  return result;
}

std::vector<Shape> yin_part() {
  const nlohmann::json json = reference("p0_A4_cylinder.json");
  Shape cylinder, top, side;
  cylinder.kind = ShapeKind::cylinder;
  cylinder.point = {json["cyl_axis_x"].get<double>(), json["cyl_axis_y"].get<double>(), 0};
  cylinder.direction = Eigen::Vector3d::UnitZ();
  cylinder.radius = json["R"];
  top.kind = side.kind = ShapeKind::plane;
  top.point = {0, 0, 205};
  top.direction = Eigen::Vector3d::UnitZ();
  side.point = {155, 0, 0};
  side.direction = Eigen::Vector3d::UnitX();
  return {cylinder, top, side};
}

std::vector<YinPoint> yin_curve() {
  const Curve curve = read_curve(shared_file("examples/laser_engraver/table-a4.csv"), Machine{});
  const double radius = yin_part().front().radius;
  std::vector<YinPoint> points;
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    places.push_back(curve.points[i].point);
    const Eigen::Vector3d& before = curve.points[i == 0 ? 0 : i - 1].point;
    const Eigen::Vector3d& after = curve.points[std::min(i + 1, curve.points.size() - 1)].point;
    const Eigen::Vector3d normal = curve.points[i].direction;
    Eigen::Vector3d tangent = after - before;
    tangent = (tangent - normal.dot(tangent) * normal).normalized();
    // Across the curve the cylinder is as round as that direction is along its circumference.
    const double around = normal.cross(tangent).dot(Eigen::Vector3d::UnitZ().cross(normal));
    points.push_back({curve.points[i].point, normal, tangent, 0, around * around / radius});
  }
  const std::vector<double> along = CommandCurve(matrix_of(places)).along();
  for (std::size_t i = 0; i < points.size(); ++i) points[i].along = along[i];
  return points;
}

}  // namespace abbe
