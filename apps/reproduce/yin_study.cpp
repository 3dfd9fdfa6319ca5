#include "reproduce/yin_study.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/csv_reader.h"
#include "abbe/formats/curve_file.h"
#include "abbe/formats/text_file.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/chain.h"
#include "abbe/verify/covariance_root.h"
#include "command.h"

namespace abbe {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kTargetNoise = 0.010, kSurfaceNoise = 0.020, kLineScannerNoise = 0.002;  // mm
constexpr double kExitToAxis = 120, kBoard = 4;                                           // mm, as in the reference
constexpr double kWaist = 0.03, kDivergence = 0.05;

nlohmann::json reference(const char* name) {
  return nlohmann::json::parse(read_text_file(shared_file(std::string("golden/yin/") + name)));
}

LinkageReadings readings_of(const nlohmann::json& raw, LinkageConvention convention) {
  LinkageReadings r;
  r.convention = convention;
  const nlohmann::json &two = raw["step2"], &three = raw["step3"], &four = raw["step4"], &five = raw["step5"];
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
  return r;
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
    if (labels != nullptr)
      labels->push_back(static_cast<std::size_t>(std::clamp(table.columns[3].numbers[i], 0.0, 2.0)));
  }
  return points;
}

Eigen::Matrix3Xd columns_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = points[i];
  return result;
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

double difference(const RigidTransform& a, const RigidTransform& b) {
  return std::max((a.translation - b.translation).norm(), 1000 * (a.rotation - b.rotation).norm());
}

std::vector<Shape> part() {
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

/// Commands for a point and a direction in the table's frame, convention U, branch A > 0.
SwingHeadCommand command_for(const SwingHeadLinkage& linkage, const Eigen::Vector3d& p, const Eigen::Vector3d& v) {
  SwingHeadCommand c;
  c.a = std::atan2(std::hypot(v.x(), v.y()), v.z());
  c.c1 = std::atan2(v.x(), -v.y());
  const Eigen::Vector3d at_zero = swing_head_focus(linkage, LinkageConvention::table_moves, c);
  c.x = at_zero.x() - p.x();
  c.y = at_zero.y() - p.y();
  c.z = p.z() - at_zero.z();
  return c;
}

/// The whole chain from measuring the machine to measuring the engraved curve; inputs in units of their uncertainties.
class Engraving {
 public:
  explicit Engraving(const YinPositioning& positioning) : curve_(yin_curve()), truth_(yin_linkage()) {
    const LinkageAccuracy accuracy = LinkageAccuracy::published();
    commands_ = linkage_commands(truth_, LinkageConvention::table_moves, kExitToAxis, kBoard);
    for (const LinkageDisturbance& d : linkage_disturbances(commands_, accuracy)) {
      const bool zero = d.cause.starts_with("zero");
      inputs_.push_back({zero ? d.cause : "linkage: " + d.cause, d.standard_uncertainty});
    }
    linkage_count_ = inputs_.size();
    table_from_workpiece_ = positioning.placement.table_from_workpiece;
    placement_root_ = covariance_root(*positioning.placement.covariance);
    for (Eigen::Index k = 0; k < placement_root_.cols(); ++k) inputs_.push_back({"placement of the workpiece", 1});
    inputs_.push_back({"C2 at work", accuracy.c2});
    for (std::size_t i = 0; i < curve_.size(); ++i) {
      inputs_.push_back({"X at work", accuracy.x});
      inputs_.push_back({"Y at work", accuracy.y});
      inputs_.push_back({"Z at work", accuracy.z});
      inputs_.push_back({"A at work", accuracy.a});
      inputs_.push_back({"C1 at work", accuracy.c1});
      inputs_.push_back({"line scanner", kLineScannerNoise});
    }
  }

  struct Input {
    std::string cause;
    double uncertainty = 0;
  };
  const std::vector<Input>& inputs() const { return inputs_; }
  std::size_t points() const { return curve_.size(); }

  /// Places of the marks against the curve, [2, points] mm: across the curve and along it, in the surface.
  Eigen::Matrix2Xd marks(const std::vector<double>& x, bool printed_l_ta = false) const {
    std::vector<double> disturbance(linkage_count_);
    for (std::size_t i = 0; i < linkage_count_; ++i) disturbance[i] = x[i] * inputs_[i].uncertainty;
    const LinkageEvaluation measured =
        evaluate_linkage(simulate_linkage(truth_, commands_, kWaist, kDivergence, disturbance), {});
    SwingHeadLinkage linkage = measured.linkage;
    if (printed_l_ta) {
      // The signed distance of the lines itself, with what (11) and (12) make of it.
      linkage.beam_offset *= 2;
      linkage.a_offset -= linkage.beam_offset / 2;
    }
    std::size_t at = linkage_count_;
    Vector6 motion = Vector6::Zero();
    for (Eigen::Index k = 0; k < placement_root_.cols(); ++k) motion += x[at++] * placement_root_.col(k);
    // The workpiece was measured a small motion away from where it is.
    const RigidTransform measured_place = {rotation_from_vector(motion.tail<3>()) * table_from_workpiece_.rotation,
                                           table_from_workpiece_.translation + Eigen::Vector3d(motion.head<3>())};
    const double c2 = x[at] * inputs_[at].uncertainty;
    ++at;
    const Eigen::Matrix3d turned = rotation_about(Eigen::Vector3d::UnitZ(), c2);
    const RigidTransform workpiece_from_table = table_from_workpiece_.inverse();
    Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(curve_.size()));
    for (std::size_t i = 0; i < curve_.size(); ++i) {
      const YinPoint& point = curve_[i];
      SwingHeadCommand c = command_for(linkage, measured_place * point.point, measured_place.rotation * point.normal);
      const auto next = [&] {
        const double value = x[at] * inputs_[at].uncertainty;
        ++at;
        return value;
      };
      c.x += next();
      c.y += next();
      c.z += next();
      c.a += next() + disturbance[0];  // the zeros of step 1 are those of the machine at work
      c.c1 += next() + disturbance[1];
      const double scanner = next();
      const Eigen::Vector3d focus =
          workpiece_from_table * (turned * swing_head_focus(truth_, LinkageConvention::table_moves, c));
      const Eigen::Vector3d beam = workpiece_from_table.rotation * (turned * swing_head_beam(c));
      const Eigen::Vector3d off = focus - point.point;
      const Eigen::Vector3d mark = off - beam * (off.dot(point.normal) / beam.dot(point.normal));
      result.col(static_cast<Eigen::Index>(i)) << mark.dot(point.normal.cross(point.tangent)) + scanner,
          mark.dot(point.tangent);
    }
    return result;
  }

 private:
  std::vector<YinPoint> curve_;
  SwingHeadLinkage truth_;
  LinkageReadings commands_;
  std::vector<Input> inputs_;
  std::size_t linkage_count_ = 0;
  RigidTransform table_from_workpiece_;
  Eigen::MatrixXd placement_root_;
};

ContourFigures figures_of(const Eigen::VectorXd& amounts) {
  const auto n = static_cast<double>(amounts.size());
  const double mean = amounts.mean();
  return {1e3 * mean, 1e3 * amounts.maxCoeff(), 1e3 * std::sqrt((amounts.array() - mean).square().sum() / (n - 1))};
}

void add(ContourFigures& sum, const ContourFigures& one, double share) {
  sum.mean += share * one.mean;
  sum.largest += share * one.largest;
  sum.deviation += share * one.deviation;
}

double below_which_95_percent(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, values.size() * 95 / 100)];
}

}  // namespace

SwingHeadLinkage yin_linkage() { return {240.745, 209.476, -0.265, -0.145, {-197.236, 25.306, -528.996}}; }

YinSteps yin_steps(LinkageConvention convention) {
  const nlohmann::json json = reference("linkage_five_steps.json");
  const nlohmann::json& own = json[convention == LinkageConvention::table_moves ? "U" : "P"];
  YinSteps steps;
  steps.found = evaluate_linkage(readings_of(own["raw"], convention), LinkageAccuracy::published());
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    const char* name = linkage_name(i);
    for (const double off : {steps.found.linkage.values()[i] - own["recovered"][name].get<double>(),
                             steps.found.printed.values()[i] - own["printed"][name].get<double>()}) {
      steps.largest_difference = std::max(steps.largest_difference, std::abs(off));
    }
  }
  return steps;
}

YinPositioning yin_positioning() {
  const nlohmann::json json = reference("positioning.json");
  const nlohmann::json &exact = json["exact"], &setup = json["setup"];
  PositioningScans scans;
  scans.along_x = scan("PX");
  scans.along_y = scan("PY");
  scans.circles = {scan("C1"), scan("C2")};
  scans.sphere = scan("S");
  scans.sphere_height = setup["ZP"];
  for (std::size_t i = 0; i < 3; ++i) scans.moved_since[static_cast<Eigen::Index>(i)] = setup["DEL"][i];
  scans.target_noise = kTargetNoise;
  scans.sphere_noise = kSurfaceNoise;
  YinPositioning result;
  result.scanner = locate_scanner(scans);
  std::vector<std::size_t> labels;
  const Eigen::Matrix3Xd surface = columns_of(scan("M", &labels));
  FeatureRegistrationOptions options;
  options.noise_mm = kSurfaceNoise;
  result.registration = register_to_features(surface, part(), labels, transform_of(setup["initial_DMW"]), options);
  result.placement = locate_workpiece(result.scanner, result.registration);
  result.table_to_workpiece = positioning_parameters(result.placement, true);
  result.workpiece_to_table = positioning_parameters(result.placement, false);
  result.largest_difference =
      std::max({difference(result.scanner.table_from_scanner, transform_of(exact["DMB"])),
                difference(result.registration.mesh_from_scan, transform_of(exact["DMW"])),
                difference(result.placement.table_from_workpiece.inverse(), transform_of(exact["DBW"]))});
  return result;
}

std::vector<YinPoint> yin_curve() {
  const Machine machine = parse_chain("w C2' X Y b Z C1 A t").machine;
  const Curve curve = read_curve(shared_file("examples/laser_engraver/table-a4.csv"), machine);
  std::vector<YinPoint> points;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const Eigen::Vector3d& before = curve.points[i == 0 ? 0 : i - 1].point;
    const Eigen::Vector3d& after = curve.points[std::min(i + 1, curve.points.size() - 1)].point;
    const Eigen::Vector3d normal = curve.points[i].direction;
    Eigen::Vector3d tangent = after - before;
    tangent -= normal.dot(tangent) * normal;
    points.push_back({curve.points[i].point, normal, tangent.normalized()});
  }
  return points;
}

YinContour yin_contour(const YinPositioning& positioning, std::size_t runs, std::uint64_t seed) {
  const Engraving engraving(positioning);
  const std::vector<Engraving::Input>& inputs = engraving.inputs();
  const auto n = static_cast<double>(engraving.points());
  YinContour result;
  result.runs = runs;
  result.causes = inputs.size();
  std::vector<double> x(inputs.size(), 0.0);
  result.printed_l_ta = 1e3 * engraving.marks(x, true).row(0).cwiseAbs().maxCoeff();

  std::map<std::string, BudgetShare> shares;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    x[k] = 1;
    Eigen::Matrix2Xd change = engraving.marks(x);
    x[k] = -1;
    change -= engraving.marks(x);
    x[k] = 0;
    BudgetShare& share = shares[inputs[k].cause];
    share.across += change.row(0).squaredNorm() / 4 / n * 1e6;
    share.in_surface += change.squaredNorm() / 4 / n * 1e6;
  }
  for (auto& [cause, share] : shares) {
    result.across += share.across;
    result.in_surface += share.in_surface;
    result.shares.push_back({cause, std::sqrt(share.across), std::sqrt(share.in_surface)});
  }
  std::stable_sort(result.shares.begin(), result.shares.end(),
                   [](const BudgetShare& a, const BudgetShare& b) { return a.across > b.across; });
  result.across = std::sqrt(result.across);
  result.in_surface = std::sqrt(result.in_surface);

  RandomStream random(seed);
  std::vector<double> means, largest, deviations;
  for (std::size_t run = 0; run < runs; ++run) {
    for (double& value : x) value = random.normal();
    const Eigen::Matrix2Xd marks = engraving.marks(x);
    const ContourFigures across = figures_of(marks.row(0).cwiseAbs().transpose());
    const double share = 1 / static_cast<double>(runs);
    add(result.measured, across, share);
    add(result.whole, figures_of(marks.colwise().norm().transpose()), share);
    means.push_back(across.mean);
    largest.push_back(across.largest);
    deviations.push_back(across.deviation);
    result.sampled_across += marks.row(0).squaredNorm() / n * share * 1e6;
    result.sampled_in_surface += marks.squaredNorm() / n * share * 1e6;
  }
  result.sampled_across = std::sqrt(result.sampled_across);
  result.sampled_in_surface = std::sqrt(result.sampled_in_surface);
  if (runs > 0) {
    result.upper = {below_which_95_percent(means), below_which_95_percent(largest), below_which_95_percent(deviations)};
  }
  return result;
}

}  // namespace abbe
