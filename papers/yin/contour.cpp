#include "yin/contour.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/engraved_edge.h"
#include "abbe/instruments/triangulation.h"
#include "abbe/verify/covariance_root.h"
#include "abbe/verify/evaluations/statistics.h"
#include "yin/constants.h"

namespace abbe {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The whole chain from measuring the machine to measuring the engraved curve.
class Engraving {
 public:
  explicit Engraving(const YinPositioning& positioning) : curve_(yin_curve()), truth_(yin_linkage()) {
    const LinkageAccuracy accuracy = LinkageAccuracy::published();
    commands_ = linkage_commands(truth_, LinkageConvention::table_moves, yin::kExitToAxis, yin::kBoard);
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
      inputs_.push_back({"line scanner", yin::kSectionPlace});
    }
    exact_ = measured_linkage(std::vector<double>(inputs_.size(), 0.0));
  }

  const std::vector<BudgetInput>& inputs() const { return inputs_; }
  const std::vector<YinPoint>& curve() const { return curve_; }

  /// Places of the marks against the curve, [2, points] mm: across the curve and along it, in the surface.
  /// @param deviations  [inputs] mm, rad
  /// @param tilt        null or filled: [points] rad, of the beam in the section against the surface's normal
  Eigen::MatrixXd marks(const std::vector<double>& deviations, bool printed_l_ta = false,
                        std::vector<double>* tilt = nullptr) const {
    const std::span<const double> steps(deviations.data(), linkage_count_);
    const bool undisturbed = std::all_of(steps.begin(), steps.end(), [](double d) { return d == 0; });
    SwingHeadLinkage linkage = undisturbed ? exact_ : measured_linkage(deviations);
    if (printed_l_ta) {
      // The signed distance of the lines itself, with what (11) and (12) make of it.
      linkage.beam_offset *= 2;
      linkage.a_offset -= linkage.beam_offset / 2;
    }
    std::size_t at = linkage_count_;
    const auto next = [&] { return deviations[at++]; };
    Vector6 motion = Vector6::Zero();
    for (Eigen::Index k = 0; k < placement_root_.cols(); ++k) motion += next() * placement_root_.col(k);
    // The workpiece was measured a small motion away from where it is.
    const RigidTransform measured_place = {rotation_from_vector(motion.tail<3>()) * table_from_workpiece_.rotation,
                                           table_from_workpiece_.translation + Eigen::Vector3d(motion.head<3>())};
    const Eigen::Matrix3d turned = rotation_about(Eigen::Vector3d::UnitZ(), next());
    const RigidTransform workpiece_from_table = table_from_workpiece_.inverse();
    Eigen::MatrixXd result(2, static_cast<Eigen::Index>(curve_.size()));
    if (tilt != nullptr) tilt->clear();
    for (std::size_t i = 0; i < curve_.size(); ++i) {
      const YinPoint& point = curve_[i];
      SwingHeadCommand c = swing_head_command(linkage, LinkageConvention::table_moves, measured_place * point.point,
                                              measured_place.rotation * point.normal);
      c.x += next();
      c.y += next();
      c.z += next();
      c.a += next() + deviations[0];  // the zeros of step 1 are those of the machine at work
      c.c1 += next() + deviations[1];
      const double scanner = next();
      const Eigen::Vector3d focus =
          workpiece_from_table * (turned * swing_head_focus(truth_, LinkageConvention::table_moves, c));
      const Eigen::Vector3d beam = workpiece_from_table.rotation * (turned * swing_head_beam(c));
      const Eigen::Vector3d off = focus - point.point;
      const Eigen::Vector3d mark = off - beam * (off.dot(point.normal) / beam.dot(point.normal));
      const Eigen::Vector3d across = point.normal.cross(point.tangent);
      result.col(static_cast<Eigen::Index>(i)) << mark.dot(across) + scanner, mark.dot(point.tangent);
      if (tilt != nullptr) tilt->push_back(std::atan2(beam.dot(across), beam.dot(point.normal)));
    }
    return result;
  }

 private:
  SwingHeadLinkage measured_linkage(const std::vector<double>& deviations) const {
    const std::span<const double> steps(deviations.data(), linkage_count_);
    return evaluate_linkage(simulate_linkage(truth_, commands_, yin::kWaist, yin::kDivergence, steps), {}).linkage;
  }

  std::vector<YinPoint> curve_;
  SwingHeadLinkage truth_, exact_;
  LinkageReadings commands_;
  std::vector<BudgetInput> inputs_;
  std::size_t linkage_count_ = 0;
  RigidTransform table_from_workpiece_;
  Eigen::MatrixXd placement_root_;
};

YinFigures figures_of(const Eigen::VectorXd& amounts) {
  return yin_figures({amounts.data(), static_cast<std::size_t>(amounts.size())});
}

void add(YinFigures& sum, const YinFigures& one, double share) {
  sum.mean += share * one.mean;
  sum.largest += share * one.largest;
  sum.deviation += share * one.deviation;
}

}  // namespace

YinFigures yin_figures(std::span<const double> amounts) {
  const SampleStatistics s = sample_statistics(amounts);
  return {1e3 * s.mean, 1e3 * s.maximum, 1e3 * s.deviation};
}

YinContour yin_contour(const YinPositioning& positioning, const BudgetOptions& options) {
  const Engraving engraving(positioning);
  YinContour result;
  result.printed_l_ta =
      1e3 * engraving.marks(std::vector<double>(engraving.inputs().size(), 0.0), true).row(0).cwiseAbs().maxCoeff();
  std::vector<double> means, largest, deviations;
  const double share = options.runs > 0 ? 1 / static_cast<double>(options.runs) : 0;
  result.budget =
      uncertainty_budget([&](const std::vector<double>& x) { return engraving.marks(x); }, engraving.inputs(), options,
                         [&](const Eigen::MatrixXd& marks) {
                           const YinFigures across = figures_of(marks.row(0).cwiseAbs().transpose());
                           add(result.across, across, share);
                           add(result.in_surface, figures_of(marks.colwise().norm().transpose()), share);
                           means.push_back(across.mean);
                           largest.push_back(across.largest);
                           deviations.push_back(across.deviation);
                         });
  result.upper = {percentile(means, 0.95), percentile(largest, 0.95), percentile(deviations, 0.95)};
  return result;
}

YinSections yin_sections(const YinPositioning& positioning, std::uint64_t seed) {
  const Engraving engraving(positioning);
  std::vector<double> deviations;
  RandomStream machine(seed);
  for (const BudgetInput& input : engraving.inputs()) {
    // The scanner's part is drawn by the scanner itself.
    const double drawn = input.standard_uncertainty * machine.normal();
    deviations.push_back(input.cause == "line scanner" ? 0 : drawn);
  }
  std::vector<double> tilt;
  const Eigen::MatrixXd marks = engraving.marks(deviations, false, &tilt);
  YinSections result;
  result.radius = yin::kEdgeRadius;
  LineScanner scanner = LineScanner::published();
  result.options.across_noise = scanner.across_noise;
  result.options.height_noise = scanner.height_noise;
  for (Eigen::Index i = 0; i < marks.cols(); ++i) {
    const YinPoint& point = engraving.curve()[static_cast<std::size_t>(i)];
    EngravedEdge edge;
    edge.corner = {marks(0, i), -point.curvature * marks(0, i) * marks(0, i) / 2};
    edge.radius = yin::kEdgeRadius;
    edge.depth = yin::kEdgeDepth;
    edge.beam_tilt = tilt[static_cast<std::size_t>(i)];
    edge.surface_curvature = point.curvature;
    const RayTracer part(engraved_mesh(edge, scanner.width, 1));
    RandomStream random(seed, static_cast<std::uint64_t>(i) + 1);
    SectionReadings section;
    section.name = std::to_string(i + 1);
    section.along = point.along;
    section.points = scan_section(scanner, part, {}, random).points;
    section.points.row(0).array() += yin::kSectionPlace * random.normal();
    result.edge.push_back(marks(0, i));
    result.curvature.push_back(point.curvature);
    result.sections.push_back(std::move(section));
  }
  evaluate_sections(result);
  return result;
}

void evaluate_sections(YinSections& sections) {
  sections.fits.clear();
  sections.refused = 0;
  sections.largest_miss = 0;
  std::vector<double> truth, found, rounding;
  for (std::size_t i = 0; i < sections.sections.size(); ++i) {
    EdgeOptions options = sections.options;
    options.surface_curvature = sections.curvature[i];
    sections.fits.push_back(fit_edge(sections.sections[i].points, options));
    const EdgeFit& fit = sections.fits.back();
    if (fit.status != EdgeStatus::ok) {
      ++sections.refused;
      continue;
    }
    truth.push_back(std::abs(sections.edge[i]));
    found.push_back(std::abs(fit.corner.x()));
    rounding.push_back(fit.rounding);
    sections.largest_miss = std::max(sections.largest_miss, std::abs(fit.corner.x() - sections.edge[i]));
  }
  sections.truth = yin_figures(truth);
  sections.found = yin_figures(found);
  sections.rounding = yin_figures(rounding);
}

}  // namespace abbe
