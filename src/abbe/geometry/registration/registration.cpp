#include "abbe/geometry/registration/registration.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/even_choice.h"
#include "abbe/geometry/registration/pair_search.h"
#include "abbe/geometry/registration/pose_difference.h"
#include "abbe/geometry/registration/shared_fits.h"
#include "abbe/geometry/registration/triple_search.h"

namespace abbe {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr Eigen::Index kPartSamples = 600, kTripleSamples = 300;
constexpr Eigen::Index kEnoughNormals = 256;  ///< of the thinned scan, for the search by pairs alone
constexpr Eigen::Index kRoughPoints = 400, kComparedPoints = 2500, kFirstFinePoints = 50000;
constexpr std::size_t kCompared = 12;
constexpr double kSamePose = 0.02;     ///< of the diameter: nearer poses count as one
constexpr double kWorse = 4;           ///< times the best deviation: such poses are no alternatives
constexpr double kRoughScale = 0.001;  ///< of the diameter: the least scale at which rough poses are compared
constexpr double kSettled = 0.02;      ///< of the uncertainty of a mean over all points
constexpr double kHopeless = 0.65;     ///< of the best score: rougher starts are not refined

Matrix3Xd some_of(const Matrix3Xd& points, Eigen::Index count) { return EvenChoice(points.cols(), count).of(points); }

/// A pose with the loss of every compared point, 0 .. 1.
struct Compared {
  FineRegistration fine;
  std::vector<double> loss;
  double mean = 0;
};

}  // namespace

const char* registration_status_name(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::not_run:
      return "not_run";
    case RegistrationStatus::ok:
      return "ok";
    case RegistrationStatus::too_few_points:
      return "too_few_points";
    case RegistrationStatus::no_start:
      return "no_start";
    case RegistrationStatus::not_converged:
      return "not_converged";
    case RegistrationStatus::undetermined:
      return "undetermined";
    case RegistrationStatus::ambiguous:
      return "ambiguous";
  }
  return "not_run";
}

struct RegistrationTarget::Inside {
  RegistrationOptions options;
  ClosestPointFinder surface;
  SmoothSurface smooth;
  PointCloud samples;
  Vector3d low, high;
  double diameter = 0;

  Inside(const TriangleMesh& mesh, const RegistrationOptions& given)
      : options(given),
        surface(mesh, given.threads),
        smooth(mesh, given.crease_angle, given.threads),
        samples(sample_surface(mesh, kPartSamples, given.seed)),
        low(mesh.vertices.rowwise().minCoeff()),
        high(mesh.vertices.rowwise().maxCoeff()),
        diameter((high - low).norm()) {}

  FineRegistrationOptions fine_options() const {
    return {.loss = options.loss,
            .adaptive_distance = options.adaptive_distance,
            .noise_mm = options.noise_mm,
            .threads = options.threads,
            .work = options.work};
  }

  std::vector<RigidTransform> starts(const PointCloud& scan) const {
    if (options.start) return {*options.start};
    const double reach = 0.035 * diameter;
    const DistanceGrid grid(surface, low, high, 2 * reach, 64, options.threads, options.work);
    const ThinnedScan thinned = thin_scan(scan, 0.03 * diameter);
    std::vector<RigidTransform> poses;
    const auto take = [&](const std::vector<PoseCandidate>& found) {
      for (const PoseCandidate& candidate : found) {
        if (candidate.score < kHopeless * found.front().score) break;
        poses.push_back(candidate.mesh_from_scan);
      }
    };
    take(search_poses(samples, thinned, grid,
                      {.seed = options.seed, .reach_mm = reach, .threads = options.threads, .work = options.work}));
    // Points too far apart for normals of their own, or none that agree with the part's.
    if (poses.empty() || (!thinned.outwards && thinned.points.cols() < kEnoughNormals)) {
      take(search_triples(some_of(samples.points, kTripleSamples), thinned.places, grid,
                          {.seed = options.seed, .reach_mm = reach}));
    }
    return poses;
  }

  Compared compare(const Matrix3Xd& points, FineRegistration fine, double scale) const {
    Compared result;
    const Matrix3Xd moved = (fine.mesh_from_scan.rotation * points).colwise() + fine.mesh_from_scan.translation;
    for (const SurfacePoint& at : surface.closest(moved, options.threads)) {
      const double u = at.distance / (kWelschTuning * scale);
      result.loss.push_back(at.on_border ? 1 : 1 - std::exp(-u * u));
      result.mean += result.loss.back() / static_cast<double>(points.cols());
    }
    result.fine = std::move(fine);
    return result;
  }
};

RegistrationTarget::RegistrationTarget(const TriangleMesh& mesh, const RegistrationOptions& options)
    : inside_(std::make_unique<const Inside>(mesh, options)) {}
RegistrationTarget::~RegistrationTarget() = default;

const ClosestPointFinder& RegistrationTarget::surface() const { return inside_->surface; }

Registration RegistrationTarget::register_scan(const PointCloud& scan,
                                               const std::function<void(std::size_t, std::size_t)>& progress) const {
  Registration result;
  // Shares of the time, roughly.
  const auto report = [&](std::size_t percent) {
    if (progress) progress(percent, 100);
  };
  if (scan.size() < 6) {
    result.status = RegistrationStatus::too_few_points;
    return result;
  }
  const Inside& in = *inside_;
  const std::vector<RigidTransform> starts = in.starts(scan);
  result.starts = starts.size();
  report(30);
  if (starts.empty()) {
    result.status = RegistrationStatus::no_start;
    return result;
  }

  // Roughly on few points; the loss reaches less far than what the poses are wrong by only after some steps.
  const Matrix3Xd rough = some_of(scan.points, kRoughPoints), compared = some_of(scan.points, kComparedPoints);
  const double extent = in.diameter / 3;
  const auto same_pose = [&](const FineRegistration& known, const RigidTransform& other) {
    return pose_difference(known.mesh_from_scan, other, known.undetermined, known.reference, extent) <
           kSamePose * in.diameter;
  };
  const auto drop_repeated = [&](std::vector<FineRegistration>* fits) {
    std::vector<FineRegistration> distinct;
    for (FineRegistration& fit : *fits) {
      const auto same = [&](const FineRegistration& known) { return same_pose(known, fit.mesh_from_scan); };
      if (std::none_of(distinct.begin(), distinct.end(), same)) distinct.push_back(std::move(fit));
    }
    *fits = std::move(distinct);
  };
  std::vector<FitStart> from;
  for (const RigidTransform& start : starts) from.push_back({start, 0.015 * in.diameter});
  FineRegistrationOptions roughly = in.fine_options();
  roughly.iterations = 15;
  roughly.movement_mm = 1e-4 * in.diameter;
  std::vector<FineRegistration> refined = register_from_each(rough, in.surface, in.smooth, from, roughly);
  const auto rank = [](const FineRegistration& a, const FineRegistration& b) { return a.scale_mm < b.scale_mm; };
  // By the loss of all points at one scale: half of them may fit exactly in many poses, as on a cylinder with flats.
  // Then the best pose has to come first, because those after it that differ by its undetermined motions are dropped.
  const double least = std::min_element(refined.begin(), refined.end(), rank)->scale_mm;
  const double worst = kWorse * least + 0.002 * in.diameter;
  std::vector<Compared> ranked;
  for (FineRegistration& fine : refined) {
    if (fine.scale_mm <= worst) {
      ranked.push_back(in.compare(rough, std::move(fine), std::max(least, kRoughScale * in.diameter)));
    }
  }
  const auto by_loss = [](const Compared& a, const Compared& b) { return a.mean < b.mean; };
  std::stable_sort(ranked.begin(), ranked.end(), by_loss);
  refined.clear();
  for (Compared& one : ranked) refined.push_back(std::move(one.fine));
  drop_repeated(&refined);
  if (refined.size() > kCompared) refined.resize(kCompared);
  from.clear();
  for (const FineRegistration& fine : refined) {
    from.push_back({fine.mesh_from_scan, std::max(fine.scale_mm, 1e-9 * in.diameter)});
  }
  roughly.iterations = 40;
  roughly.movement_mm = 1e-7 * in.diameter;
  refined = register_from_each(compared, in.surface, in.smooth, from, roughly);
  std::stable_sort(refined.begin(), refined.end(), rank);

  report(60);
  // One scale for all, so that their losses can be compared point by point.
  const double scale = std::max(refined.front().scale_mm, 1e-8 * in.diameter);
  std::vector<Compared> poses;
  for (const FineRegistration& fine : refined) poses.push_back(in.compare(compared, fine, scale));
  std::stable_sort(poses.begin(), poses.end(), by_loss);

  // The rest of the way in two steps: few points are quick, and from there all need two or three passes.
  RigidTransform pose = poses.front().fine.mesh_from_scan;
  FineRegistrationOptions options = in.fine_options();
  options.largest_scale_mm = 3 * scale;
  // Far below the uncertainty that so many points leave.
  options.movement_mm = std::max(3e-10 * in.diameter, kSettled * scale / std::sqrt(static_cast<double>(scan.size())));
  if (scan.size() > 2 * kFirstFinePoints) {
    pose = register_finely(some_of(scan.points, kFirstFinePoints), in.surface, in.smooth, pose, options).mesh_from_scan;
  }
  report(70);
  result.fine = register_finely(scan.points, in.surface, in.smooth, pose, options);

  report(95);
  std::vector<RigidTransform> distinct{result.fine.mesh_from_scan};
  for (const Compared& other : poses) {
    const auto same = [&](const RigidTransform& known) {
      return pose_difference(known, other.fine.mesh_from_scan, result.fine.undetermined, result.fine.reference,
                             extent) < kSamePose * in.diameter;
    };
    if (std::any_of(distinct.begin(), distinct.end(), same)) continue;
    double sum = 0, squares = 0;
    const double count = static_cast<double>(other.loss.size());
    for (std::size_t i = 0; i < other.loss.size(); ++i) {
      const double difference = other.loss[i] - poses.front().loss[i];
      sum += difference;
      squares += difference * difference;
    }
    const double mean = sum / count;
    const double uncertainty = std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
    if (mean > 3 * uncertainty + 0.005) continue;
    distinct.push_back(other.fine.mesh_from_scan);
    result.alternatives.push_back({other.fine.mesh_from_scan, mean, uncertainty});
  }

  const Matrix3Xd moved =
      (result.fine.mesh_from_scan.rotation * compared).colwise() + result.fine.mesh_from_scan.translation;
  Eigen::Index inliers = 0;
  for (const SurfacePoint& at : in.surface.closest(moved, in.options.threads)) {
    if (!at.on_border && std::abs(at.distance) <= 3 * std::max(result.fine.scale_mm, 1e-9 * in.diameter)) ++inliers;
  }
  result.inlier_share = static_cast<double>(inliers) / static_cast<double>(compared.cols());
  result.status = result.fine.status == FineRegistrationStatus::too_few_points  ? RegistrationStatus::no_start
                  : result.fine.status == FineRegistrationStatus::not_converged ? RegistrationStatus::not_converged
                  : !result.alternatives.empty()                                ? RegistrationStatus::ambiguous
                  : result.fine.status == FineRegistrationStatus::undetermined  ? RegistrationStatus::undetermined
                                                                                : RegistrationStatus::ok;
  return result;
}

}  // namespace abbe
