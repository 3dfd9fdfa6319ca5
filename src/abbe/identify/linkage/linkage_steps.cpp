#include "abbe/identify/linkage/linkage_steps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

constexpr double kRightAngle = std::numbers::pi / 2;
// So many times better must the circle fit with the angles reversed to say that they are.
constexpr double kReversedMisfit = 5;

/// dp/dX: +1 where the axes carry the head, -1 where they carry the table. The same number turns heights into -p_z.
double sense(LinkageConvention convention) { return convention == LinkageConvention::table_moves ? -1.0 : 1.0; }

struct Parabola {
  double lowest = 0, value = 0, curvature = 0;
};

/// Weighted parabola through the squares of the widths: their variance is 4 width^2 of that of a width, so the weights
/// are taken from a first, unweighted fit.
bool fit_parabola(const std::vector<double>& z, const std::vector<double>& width, Parabola& result) {
  const auto n = static_cast<Eigen::Index>(z.size());
  double middle = 0, extent = 0;
  for (const double v : z) middle += v / static_cast<double>(z.size());
  for (const double v : z) extent = std::max(extent, std::abs(v - middle));
  const double widest_line = *std::max_element(width.begin(), width.end()), widest = widest_line * widest_line;
  if (!(extent > 0) || !(widest > 0)) return false;
  Eigen::VectorXd fitted = Eigen::VectorXd::Ones(n);
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::MatrixXd rows(n, 3);
    Eigen::VectorXd right(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double t = (z[static_cast<std::size_t>(i)] - middle) / extent;
      const double w = width[static_cast<std::size_t>(i)], weight = 1 / std::sqrt(fitted[i]);
      rows.row(i) << weight, weight * t, weight * t * t;
      right[i] = weight * w * w;
    }
    c = PivotedQr(rows).solve(right);
    if (!(c[2] > 0) || !c.allFinite()) return false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double t = (z[static_cast<std::size_t>(i)] - middle) / extent;
      fitted[i] = std::max(c[0] + t * (c[1] + t * c[2]), 1e-3 * widest);
    }
  }
  const double t = -c[1] / (2 * c[2]);
  result = {middle + extent * t, c[0] + t * (c[1] + t * c[2]), c[2] / (extent * extent)};
  return true;
}

/// Arm r and centre c of marks m = c + R(angle) r, by linear least squares.
/// @param direction  +1, or -1 for the angles with the other sign
/// @param misfit     root of the sum of squares, mm
bool fit_arm(const std::vector<double>& angle, double direction, const std::vector<Eigen::Vector2d>& marks,
             Eigen::Vector2d& arm, double& misfit) {
  const auto n = static_cast<Eigen::Index>(angle.size());
  Eigen::MatrixXd rows(2 * n, 4);
  Eigen::VectorXd right(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double turn = direction * angle[static_cast<std::size_t>(i)], c = std::cos(turn), s = std::sin(turn);
    rows.row(2 * i) << 1, 0, c, -s;
    rows.row(2 * i + 1) << 0, 1, s, c;
    right.segment<2>(2 * i) = marks[static_cast<std::size_t>(i)];
  }
  PivotedQr solver(rows);
  solver.set_threshold(1e-6);
  if (solver.rank() < 4) return false;
  const Eigen::VectorXd found = solver.solve(right);
  arm = found.tail<2>();
  misfit = (rows * found - right).norm();
  return true;
}

LinkageEvaluation refused(LinkageStatus status, std::string reason) {
  LinkageEvaluation result;
  result.status = status;
  result.reason = std::move(reason);
  return result;
}

/// Everything but the covariance.
LinkageEvaluation evaluate_steps(const LinkageReadings& r) {
  if (r.focus_z.size() < 4 || r.focus_width.size() != r.focus_z.size()) {
    return refused(LinkageStatus::too_few_readings, "fewer than four widths for the parabola of the focus");
  }
  if (r.circle_marks.size() != r.table_angle.size() || r.table_angle.size() == 1) {
    return refused(LinkageStatus::too_few_readings, "one mark is no circle about the table's axis");
  }
  LinkageEvaluation result;
  Parabola parabola;
  if (!fit_parabola(r.focus_z, r.focus_width, parabola)) {
    return refused(LinkageStatus::no_focus, "the widths have no smallest value over the series");
  }
  const auto [lowest_z, highest_z] = std::minmax_element(r.focus_z.begin(), r.focus_z.end());
  if (parabola.lowest < *lowest_z || parabola.lowest > *highest_z) {
    return refused(LinkageStatus::focus_outside, "the focus lies outside the series of widths");
  }
  if (!r.circle_marks.empty()) {
    double misfit = 0, misfit_reversed = 0;
    Eigen::Vector2d reversed;
    if (!fit_arm(r.table_angle, 1, r.circle_marks, result.circle_arm, misfit)) {
      return refused(LinkageStatus::circle_undetermined, "the table has not turned between the marks of the circle");
    }
    // Angles with the wrong sign make no circle, and an arm that is wrong by its own length.
    if (fit_arm(r.table_angle, -1, r.circle_marks, reversed, misfit_reversed) &&
        misfit > std::max(kReversedMisfit * misfit_reversed, 1e-9)) {
      return refused(LinkageStatus::circle_reversed,
                     "the marks of the circle run opposite to the stated angles: their sign is wrong");
    }
  }
  result.status = LinkageStatus::ok;
  result.focus_z = parabola.lowest;
  result.waist = std::sqrt(std::max(0.0, parabola.value));
  result.divergence = std::sqrt(parabola.curvature);
  const auto thinnest = std::min_element(r.focus_width.begin(), r.focus_width.end()) - r.focus_width.begin();
  result.thinnest_z = r.focus_z[static_cast<std::size_t>(thinnest)];

  const double s = sense(r.convention);
  const double x3 = r.circle_x - s * result.circle_arm.x(), y3 = r.circle_y - s * result.circle_arm.y();
  const double h = r.board_thickness, height_difference = r.height_first - r.height_second;
  SwingHeadLinkage& l = result.linkage;
  l.focus_to_a = std::abs(result.focus_z - r.exit_z) + r.exit_to_axis - h;
  l.beam_offset = -s * height_difference / 2;
  l.a_to_c1 = (s * (r.x_second - r.x_first) + r.line3_x - r.line5_x) / 2;
  l.a_offset = (r.line4_y - r.line6_y) / 2 - l.beam_offset;
  l.origin = {l.beam_offset + l.a_offset - s * x3, -l.a_to_c1 - s * y3, -s * r.circle_z - l.focus_to_a - h};

  SwingHeadLinkage& p = result.printed;
  p.focus_to_a = std::abs(result.focus_z - r.exit_z) + r.exit_to_axis + h;
  p.beam_offset = std::abs(height_difference);
  p.a_to_c1 = (std::abs(r.x_first - r.x_second) + std::abs(r.line3_x - r.line5_x)) / 2;
  p.a_offset = std::abs(r.line4_y - r.line6_y) / 2 - p.beam_offset;
  p.origin = {x3 + p.beam_offset + p.a_offset, y3 - p.a_to_c1, r.circle_z - p.focus_to_a - h};
  return result;
}

/// Hands out the causes of error one after the other: counts and names them, or gives them their values.
class Causes {
 public:
  Causes(const LinkageAccuracy* accuracy, std::vector<LinkageDisturbance>* list, std::span<const double> values)
      : accuracy_(accuracy), list_(list), values_(values) {}

  double next(const char* cause, double LinkageAccuracy::*standard_uncertainty) {
    if (list_ != nullptr) list_->push_back({cause, accuracy_->*standard_uncertainty});
    return next_ < values_.size() ? values_[next_++] : 0.0;
  }

 private:
  const LinkageAccuracy* accuracy_;
  std::vector<LinkageDisturbance>* list_;
  std::span<const double> values_;
  std::size_t next_ = 0;
};

/// The steps on a machine of known parameters. One path for counting the causes and for taking them, so that the two
/// cannot differ.
LinkageReadings run_steps(const SwingHeadLinkage& truth, const LinkageReadings& commands, double waist,
                          double divergence, Causes causes) {
  using A = LinkageAccuracy;
  LinkageReadings r = commands;
  const double s = sense(r.convention);
  const double zero_a = causes.next("zero of A", &A::zero_a), zero_c1 = causes.next("zero of C1", &A::zero_c1);
  r.exit_to_axis += causes.next("exit to axis d", &A::exit_to_axis);
  r.board_thickness += causes.next("board thickness h", &A::thickness);
  const auto focus = [&](double x, double y, double z, double a, double c1) {
    const SwingHeadCommand reached = {x, y, z, a + zero_a + causes.next("A", &A::a),
                                      c1 + zero_c1 + causes.next("C1", &A::c1)};
    return swing_head_focus(truth, r.convention, reached);
  };
  const auto microscope = [&] { return causes.next("microscope", &A::microscope); };

  r.exit_z = -s * (truth.origin.z() + commands.exit_to_axis) + causes.next("Z", &A::z);
  r.focus_width.resize(r.focus_z.size());
  for (std::size_t i = 0; i < r.focus_z.size(); ++i) {
    const double z = r.focus_z[i] + causes.next("Z", &A::z);
    const double above = -s * focus(0, 0, z, 0, 0).z() - commands.board_thickness;
    r.focus_width[i] = std::hypot(waist, divergence * above) + causes.next("width", &A::width);
  }

  const double level = -s * truth.origin.z();
  const auto height = [&](double a) {
    const double z = level + causes.next("Z", &A::z);
    return -s * focus(0, 0, z, a, kRightAngle).z() + 240.0 + microscope();
  };
  r.height_first = height(kRightAngle);
  r.height_second = height(-kRightAngle);

  const auto line_x = [&](double x, double c1) {
    const double at = x + causes.next("X", &A::x);
    return focus(at, 0, 0, 0, c1).x() + microscope();
  };
  const auto line_y = [&](double x, double c1) {
    const double at = causes.next("Y", &A::y);
    return focus(x, at, 0, 0, c1).y() + microscope();
  };
  r.line3_x = line_x(r.x_first, 0);
  r.line4_y = line_y(r.x_first, 0);
  r.line5_x = line_x(r.x_second, std::numbers::pi);
  r.line6_y = line_y(r.x_second, std::numbers::pi);

  const double x = r.circle_x + causes.next("X", &A::x), y = r.circle_y + causes.next("Y", &A::y);
  const Eigen::Vector3d arm = focus(x, y, 0, 0, kRightAngle);
  r.circle_marks.resize(r.table_angle.size());
  for (std::size_t i = 0; i < r.table_angle.size(); ++i) {
    const double angle = r.table_angle[i] + causes.next("C2", &A::c2);
    const double c = std::cos(angle), t = std::sin(angle);
    r.circle_marks[i] = {c * arm.x() - t * arm.y() + microscope(), t * arm.x() + c * arm.y() + microscope()};
  }
  if (r.table_angle.empty()) {  // X and Y were adjusted until the circle was a point
    r.circle_x -= s * (arm.x() + microscope());
    r.circle_y -= s * (arm.y() + microscope());
  }
  // The board has stayed where it was: the focus found in step 2 is driven to again.
  const double again = causes.next("Z", &A::z);
  Parabola parabola;
  if (fit_parabola(r.focus_z, r.focus_width, parabola)) r.circle_z = parabola.lowest + again;
  return r;
}

}  // namespace

LinkageAccuracy LinkageAccuracy::published() {
  LinkageAccuracy a;
  a.x = 2.77e-3, a.y = 1.55e-3, a.z = 3.55e-3;
  a.a = a.zero_a = 1.7 * kArcsec;
  a.c1 = a.zero_c1 = 2.4 * kArcsec;
  a.c2 = 8.3 * kArcsec;
  a.microscope = a.width = 2e-3;
  return a;
}

double LinkageEvaluation::standard_uncertainty(std::size_t parameter) const {
  const auto i = static_cast<Eigen::Index>(parameter);
  return std::sqrt(std::max(0.0, covariance(i, i)));
}

std::vector<LinkageDisturbance> linkage_disturbances(const LinkageReadings& commands, const LinkageAccuracy& accuracy) {
  std::vector<LinkageDisturbance> list;
  run_steps({}, commands, 1, 1, Causes(&accuracy, &list, {}));
  return list;
}

LinkageReadings simulate_linkage(const SwingHeadLinkage& truth, const LinkageReadings& commands, double waist,
                                 double divergence, std::span<const double> disturbances) {
  return run_steps(truth, commands, waist, divergence, Causes(nullptr, nullptr, disturbances));
}

LinkageEvaluation evaluate_linkage(const LinkageReadings& readings, const LinkageAccuracy& accuracy) {
  LinkageEvaluation result = evaluate_steps(readings);
  if (result.status != LinkageStatus::ok) return result;
  // The found machine repeats the steps with one cause at a time, once to either side.
  const std::vector<LinkageDisturbance> causes = linkage_disturbances(readings, accuracy);
  std::vector<double> values(causes.size(), 0.0);
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const double u = causes[i].standard_uncertainty;
    if (!(u > 0)) continue;
    Eigen::Matrix<double, SwingHeadLinkage::kCount, 1> change = decltype(change)::Zero();
    for (const double side : {1.0, -1.0}) {
      values[i] = side * u;
      const LinkageEvaluation moved =
          evaluate_steps(simulate_linkage(result.linkage, readings, result.waist, result.divergence, values));
      if (moved.status != LinkageStatus::ok) {
        return refused(moved.status, "the focus is so near the end of the series that its uncertainty reaches beyond");
      }
      const auto parameters = moved.linkage.values();
      for (std::size_t k = 0; k < parameters.size(); ++k) {
        change[static_cast<Eigen::Index>(k)] += side * parameters[k] / 2;
      }
    }
    values[i] = 0;
    result.covariance += change * change.transpose();
    auto share = std::find_if(result.shares.begin(), result.shares.end(),
                              [&](const LinkageShare& known) { return known.cause == causes[i].cause; });
    if (share == result.shares.end()) {
      result.shares.push_back({causes[i].cause});
      share = result.shares.end() - 1;
    }
    share->variance += change.cwiseAbs2();
  }
  return result;
}

LinkageReadings linkage_commands(const SwingHeadLinkage& about, LinkageConvention convention, double exit_to_axis,
                                 double board_thickness) {
  const double s = sense(convention);
  LinkageReadings r;
  r.convention = convention;
  r.exit_to_axis = exit_to_axis;
  r.board_thickness = board_thickness;
  // Nobody knows the focus beforehand: the series is not centred on it.
  const double focus = -s * (about.origin.z() + about.focus_to_a + board_thickness) + 0.037;
  for (int i = -12; i <= 12; ++i) r.focus_z.push_back(focus + 0.1 * i);
  r.x_second = s * std::floor(2 * about.a_to_c1);
  r.circle_x = std::round(10 * s * (about.beam_offset + about.a_offset - about.origin.x())) / 10 + 1;
  r.circle_y = std::round(10 * s * (-about.a_to_c1 - about.origin.y())) / 10 - 0.7;
  for (int i = 0; i < 12; ++i) r.table_angle.push_back(i * std::numbers::pi / 6);
  return r;
}

}  // namespace abbe
