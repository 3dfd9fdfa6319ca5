#include "abbe/geometry/fits/robust_rivals.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/fits/least_median.h"

namespace abbe::fits {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;

/// Where a candidate leads whose points are fewer than half: the median is not theirs, so that the scale comes down to
/// that of the answer by halves.
ShapeFrame reweighed_rival(const ShapeFrame& candidate, const Matrix3Xd& points, RobustSetting setting, double scale) {
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

}  // namespace

std::vector<OtherShape> other_shapes(const ShapeFrame& answer, double scale, const std::vector<ShapeFrame>& candidates,
                                     const Survey& survey, const RobustSetting& setting,
                                     const FitConstraints& constraints, std::uint64_t seed) {
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

}  // namespace abbe::fits
