#include "abbe/geometry/robust_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/least_median.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using namespace fits;

/// Weight w = psi(u) / u, and the slope of psi(u) = u w, at a distance of u tuned scales.
struct Influence {
  double weight = 0, slope = 0;
};
Influence influence(RobustKind kind, double u) {
  switch (kind) {
    case RobustKind::huber:
      return u <= 1 ? Influence{1, 1} : Influence{1 / u, 0};
    case RobustKind::tukey: {
      const double v = 1 - u * u;
      return u < 1 ? Influence{v * v, v * (1 - 5 * u * u)} : Influence{0, 0};
    }
    case RobustKind::welsch:
      break;
  }
  const double w = std::exp(-u * u);
  return {w, w * (1 - 2 * u * u)};
}

double default_tuning(RobustKind kind) {
  return kind == RobustKind::huber ? 1.345 : kind == RobustKind::tukey ? 4.685 : 2.985;
}

double change(const ShapeFrame& a, const ShapeFrame& b, double size) {
  const double radius = std::abs(a.radius - b.radius), angle = std::abs(a.half_angle - b.half_angle);
  return std::max({(a.origin - b.origin).norm() / size, radius / size, angle, (a.axes - b.axes).norm()});
}

/// What the reweighting needs to know.
struct Setting {
  RobustKind kind = RobustKind::tukey;
  double tuning = 1;
  double median_of_normal = 1;  ///< of the distance of normal points, in standard deviations of one residual
  double least_scale = 0;       ///< that of rounding, mm
  double size = 1;              ///< mm
  double largest_scale = std::numeric_limits<double>::infinity();  ///< mm
  std::size_t met = 0;  ///< points through which the shape can always be laid
  std::vector<int> free;
};

struct Reweighted {
  ShapeFrame frame;
  double scale = 0;  ///< mm
  bool rested = false;
  int iterations = 0;
};

/// Iteratively reweighted least squares until shape and scale rest.
Reweighted reweigh(const ShapeFrame& start, const FitPoints& points, const Setting& setting, int most, int threads) {
  Reweighted result;
  result.frame = start;
  std::vector<double> d(static_cast<std::size_t>(points.cols())), sorted(d.size()), weights(d.size());
  double last_change = std::numeric_limits<double>::infinity();  // of a distance, in scales
  for (int step = 0; step < most && !result.rested; ++step) {
    distances(result.frame, points, d, threads);
    std::transform(d.begin(), d.end(), sorted.begin(), [](double x) { return std::abs(x); });
    const double next = std::clamp(median_distance(sorted, setting.met) / setting.median_of_normal, setting.least_scale,
                                   std::max(setting.least_scale, setting.largest_scale));
    // Late steps keep the scale, which could go to and fro with the middle point.
    const double before = result.scale;
    if (step < 60) result.scale = next;
    for (std::size_t i = 0; i < d.size(); ++i) {
      weights[i] = influence(setting.kind, std::abs(d[i]) / (setting.tuning * result.scale)).weight;
    }
    Refined refined = refine(result.frame, points, weights, setting.free, setting.size, 2, threads);
    double moved_by = change(refined.frame, result.frame, setting.size);
    if (moved_by == 0 && !refined.converged) {
      // The one step led higher and was not taken: that is not rest. With damping it becomes short enough.
      refined = refine(result.frame, points, weights, setting.free, setting.size, 40, threads);
      moved_by = change(refined.frame, result.frame, setting.size);
    }
    ++result.iterations;
    result.frame = refined.frame;
    if (!std::isfinite(moved_by)) break;
    // In the distances rest means the same for all shapes, sizes and noises.
    distances(result.frame, points, sorted, threads);
    double changed = 0;
    for (std::size_t i = 0; i < d.size(); ++i)
      changed = std::max(changed, std::abs(std::abs(sorted[i]) - std::abs(d[i])));
    last_change = changed / result.scale;
    const bool scale_rests = std::abs(result.scale - before) <= 1e-9 * result.scale;
    const double rounding = 2e-15 * (setting.size + std::abs(result.frame.radius));
    result.rested = scale_rests && changed <= 1e-10 * result.scale + rounding;
    // With the scale at rounding there is nothing more to weigh.
    result.rested = result.rested || (moved_by < 1e-10 && result.scale <= 2 * setting.least_scale);
  }
  // Beside a saddle that is all but flat the steps grow by thousandths: stationary as a least-squares fit has to be.
  result.rested = result.rested || (result.iterations >= most && last_change <= 1e-6);
  return result;
}

/// Where a candidate leads whose points are fewer than half: the median is not theirs, so that the scale comes down to
/// that of the answer by halves.
ShapeFrame reweighed_rival(const ShapeFrame& candidate, const Matrix3Xd& points, Setting setting, double scale) {
  Reweighted rival = reweigh(candidate, points, setting, 30, 1);
  while (std::isfinite(rival.scale) && rival.scale > std::max(scale, setting.least_scale)) {
    setting.largest_scale = std::max(scale, rival.scale / 2);
    rival = reweigh(rival.frame, points, setting, 30, 1);
  }
  return rival.frame;
}

/// Losses of the sample's points, 0 on the shape to 1 beyond its reach (Tukey's, whatever the weights).
std::vector<double> losses(const ShapeFrame& frame, const Matrix3Xd& sample, double reach) {
  std::vector<double> loss;
  for (Index i = 0; i < sample.cols(); ++i) {
    const double u = std::min(1.0, std::abs(point_slopes(frame, sample.col(i)).distance) / reach);
    loss.push_back(1 - std::pow(1 - u * u, 3));
  }
  return loss;
}

/// How many of the points that the answer leaves out another shape takes.
std::size_t left_out_taken(const std::vector<double>& loss, const std::vector<double>& own_loss) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < loss.size(); ++i) count += loss[i] < 1 && own_loss[i] >= 1 ? 1 : 0;
  return count;
}

/// Another shape of the sample, compared with the answer.
struct OtherShape {
  ShapeFrame frame;
  std::vector<double> loss;
  double share = 0;        ///< of the points, those that take part
  double excess = 0;       ///< mean loss less that of the answer
  double uncertainty = 0;  ///< up to which such an excess means nothing

  bool better() const { return share >= 0.5 && excess < -uncertainty; }
  bool as_good() const { return excess <= uncertainty; }
};

/// What the other candidates lead to, and the best shape of the points that the answer leaves out, if they take a part
/// of the points that is worth naming. The mean loss of a shape is known to 0.005, and if it explains some of the
/// points left out, to three times the standard uncertainty of the difference and 0.005.
std::vector<OtherShape> other_shapes(const ShapeFrame& answer, double scale, const std::vector<ShapeFrame>& candidates,
                                     const Survey& survey, const Setting& setting, const FitConstraints& constraints,
                                     std::uint64_t seed) {
  constexpr double kLeftOut = 0.25, kWorthNaming = 0.35;
  const double reach = setting.tuning * std::max(scale, setting.least_scale);
  const double count = static_cast<double>(survey.sample.cols());
  ShapeFrame own = answer;
  own.centre.setZero();
  const std::vector<double> own_loss = losses(own, survey.sample, reach);
  const auto share_of = [&](const std::vector<double>& loss) {
    return static_cast<double>(std::count_if(loss.begin(), loss.end(), [](double x) { return x < 1; })) / count;
  };
  const double own_share = share_of(own_loss);
  std::vector<ShapeFrame> frames;
  for (const ShapeFrame& candidate : candidates) {
    if (unlike(candidate, own, survey)) {
      frames.push_back(reweighed_rival(candidate, survey.sample, setting, scale));
    }
  }
  const auto left = static_cast<Index>(std::llround((1 - own_share) * count));
  if (static_cast<double>(left) >= kLeftOut * count && left > 2 * static_cast<Index>(setting.free.size())) {
    Survey rest = survey;
    rest.sample.resize(3, left);
    Index next = 0;
    for (Index i = 0; i < survey.sample.cols(); ++i) {
      if (own_loss[static_cast<std::size_t>(i)] >= 1) rest.sample.col(next++) = survey.sample.col(i);
    }
    const std::vector<ShapeFrame> found = least_median_shapes(own.kind, rest, constraints, seed);
    if (!found.empty()) frames.push_back(reweighed_rival(found.front(), rest.sample, setting, scale));
  }
  // Another one if it lies elsewhere, or if most of its points are others.
  std::vector<OtherShape> known(1);
  known.front().frame = own;
  known.front().loss = own_loss;
  for (const ShapeFrame& frame : frames) {
    if (!std::isfinite(frame.origin.sum())) continue;
    OtherShape other;
    other.frame = frame;
    other.loss = losses(frame, survey.sample, reach);
    other.share = share_of(other.loss);
    const bool is_new = std::none_of(known.begin(), known.end(), [&](const OtherShape& one) {
      double both = 0;
      for (std::size_t i = 0; i < one.loss.size(); ++i) both += other.loss[i] < 1 && one.loss[i] < 1 ? 1 : 0;
      return both > 0.5 * other.share * count && !unlike(one.frame, frame, survey);
    });
    if (!is_new || other.share < kWorthNaming * own_share) continue;
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < own_loss.size(); ++i) {
      sum += other.loss[i] - own_loss[i];
      squares += std::pow(other.loss[i] - own_loss[i], 2);
    }
    other.excess = sum / count;
    // One that takes up to as many of the points left out as any shape can be laid through explains nothing.
    const bool explains_more = left_out_taken(other.loss, own_loss) > setting.met;
    const double variance = std::max(0.0, squares / count - other.excess * other.excess) / count;
    other.uncertainty = 0.005 + (explains_more ? 3 * std::sqrt(variance) : 0);
    known.push_back(other);
  }
  known.erase(known.begin());
  for (OtherShape& other : known) other.frame.centre = survey.centre;
  return known;
}

void add_rivals(ShapeFit& fit, const std::vector<OtherShape>& others, const Survey& survey) {
  for (const OtherShape& other : others) {
    ShapeRival rival;
    rival.shape = shape_of(other.frame, survey.centroid.mean);
    rival.share = other.share;
    fit.rivals.push_back(rival);
    if (other.as_good() && fit.ok()) {
      fit.status = FitStatus::ambiguous;
      fit.reason = "another shape explains nearly as many points";
    }
  }
  std::stable_sort(fit.rivals.begin(), fit.rivals.end(),
                   [](const ShapeRival& a, const ShapeRival& b) { return a.share > b.share; });
}

}  // namespace

ShapeFit robust_fit(ShapeKind kind, const FitPoints& points, const RobustOptions& robust, const FitOptions& options) {
  ShapeFit fit;
  fit.shape.kind = kind;
  fit.points = static_cast<std::size_t>(points.cols());
  const std::vector<int> free = free_parameters(kind, options.constraints);
  fit.parameters = static_cast<int>(free.size());
  const int rows = rows_per_point(kind);
  fit.degrees_of_freedom = points.cols() * rows - static_cast<long>(free.size());
  const Survey survey = fits::survey(kind, points, options.constraints, options.threads);
  fit.status = survey.status;
  fit.reason = survey.reason;
  if (!fit.ok()) return fit;
  std::vector<ShapeFrame> candidates = least_median_shapes(kind, survey, options.constraints, robust.seed);
  if (candidates.empty()) {
    fit.status = FitStatus::no_consensus;
    fit.reason = "no such shape comes near half of the points";
    return fit;
  }
  ShapeFrame frame = candidates.front();
  settle(frame, survey.centroid.mean);
  frame.centre = survey.centre;

  Setting setting;
  setting.kind = robust.kind;
  setting.tuning = robust.tuning > 0 ? robust.tuning : default_tuning(robust.kind);
  setting.median_of_normal = rows == 2 ? 1.1774100225154747 : 0.6744897501960817;
  setting.least_scale = 1e-14 * (survey.size + survey.centre.cwiseAbs().maxCoeff());
  setting.size = survey.size;
  setting.free = free;
  setting.met = points_met(kind, free.size());
  // The smallest median rests on one distance. Of few points another shape may leave a smaller loss at that scale, and
  // then it is the answer; it is compared with the first one at its own scale.
  constexpr int kMostSteps = 1000, kMostAnswers = 3;
  Reweighted rest;
  std::vector<OtherShape> others;
  for (int answer = 0; answer < kMostAnswers; ++answer) {
    rest = reweigh(frame, points, setting, kMostSteps, options.threads);
    fit.iterations += rest.iterations;
    frame = rest.frame;
    others = other_shapes(frame, rest.scale, candidates, survey, setting, options.constraints, robust.seed);
    const auto best = std::min_element(others.begin(), others.end(),
                                       [](const OtherShape& a, const OtherShape& b) { return a.excess < b.excess; });
    if (best == others.end() || !best->better() || answer + 1 == kMostAnswers) break;
    candidates.push_back(frame);
    candidates.back().centre.setZero();
    frame = best->frame;
    settle(frame, survey.centroid.mean);
  }
  const double scale = rest.scale, tuning = setting.tuning;

  std::vector<double> d(fit.points);
  fit.weights.resize(fit.points);
  distances(frame, points, d, options.threads);
  std::vector<double> used(fit.points);
  double psi_squares = 0, psi_slopes = 0, squares = 0, weight = 0, count = 0;
  double smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
  std::size_t smallest_at = 0, largest_at = 0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    const Influence f = influence(robust.kind, std::abs(d[i]) / (tuning * scale));
    fit.weights[i] = f.weight;
    used[i] = f.weight > 1e-3 ? 1 : 0;
    squares += f.weight * d[i] * d[i];
    weight += f.weight;
    if (used[i] == 0) continue;
    ++count;
    psi_squares += std::pow(f.weight * d[i], 2);
    // Of two residuals with one weight only that along the distance sees the weight change.
    psi_slopes += rows == 2 ? (f.weight + f.slope) / 2 : f.slope;
    if (d[i] < smallest) smallest = d[i], smallest_at = i;
    if (d[i] > largest) largest = d[i], largest_at = i;
  }
  fit.rejected = fit.points - static_cast<std::size_t>(count);
  fit.rms = weight > 0 ? std::sqrt(squares / weight) : 0;
  if (!rest.rested) {
    fit.status = FitStatus::not_converged;
    fit.reason = "weights and shape did not come to rest";
  }
  // How near half of the points are, all of them: those that any shape meets count as well.
  std::vector<double> amounts(fit.points);
  std::transform(d.begin(), d.end(), amounts.begin(), [](double x) { return std::abs(x); });
  const double nearness = std::min(scale, median_distance(amounts, 0) / setting.median_of_normal);
  if (2 * count < static_cast<double>(fit.points) || nearness > 0.15 * survey.extent[0]) {
    fit.status = FitStatus::no_consensus;
    fit.reason = "no such shape explains half of the points";
  }
  add_rivals(fit, others, survey);
  // Huber (1981), 7.6: variance of an M-estimate.
  const double freedom = count * rows - static_cast<double>(free.size());
  const double mean_slope = psi_slopes / std::max(count, 1.0);
  double sigma = options.sigma;
  if (!(sigma > 0)) sigma = freedom > 0 && mean_slope > 0.05 ? std::sqrt(psi_squares / freedom) / mean_slope : 0;
  const NormalSums sums = normal_sums(frame, points, used, options.threads);
  report_fit(fit, frame, survey, points, free, sums.matrix, sigma, options.threads);
  // The extremes that count are those of the points that took part.
  const bool same_sense = std::abs(fit.largest - d[fit.largest_at]) <= 1e-9 * (1 + std::abs(fit.largest));
  fit.smallest = same_sense ? smallest : -largest;
  fit.largest = same_sense ? largest : -smallest;
  fit.smallest_at = same_sense ? smallest_at : largest_at;
  fit.largest_at = same_sense ? largest_at : smallest_at;
  fit.form = rows == 2 ? 2 * fit.largest : fit.largest - fit.smallest;
  return fit;
}

}  // namespace abbe
