#include "abbe/geometry/fits/extreme_starts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe::fits {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Share of the smallest extent that counts as far from the shape.
constexpr double kFar = 0.05;
constexpr std::size_t kAxes = 14;
constexpr std::size_t kPlaces = 6;

/// The axis or normal turned to each of some directions, beside the centroid.
std::vector<ShapeFrame> turned(const ShapeFrame& frame, const Survey& survey, const FitConstraints& constraints) {
  std::vector<Vector3d> directions = half_sphere(kAxes);
  for (int k = 0; k < 3; ++k) directions.push_back(survey.directions.col(k));
  std::vector<ShapeFrame> starts;
  for (const Vector3d& direction : directions) {
    ShapeFrame other = frame;
    if (frame.kind == ShapeKind::circle3) {
      if (!frame_along(frame.kind, axes_along(direction), survey.sample, constraints, other)) continue;
      // The circle along the axis was sought for all heights.
      other.origin += (survey.centroid.mean - other.origin).dot(other.axes.col(2)) * other.axes.col(2);
    } else {
      other.axes = axes_along(direction);
      other.origin = survey.centroid.mean;
    }
    starts.push_back(other);
  }
  return starts;
}

/// Climbs to where the nearest points lie on all sides.
Vector3d roomiest_near(const Eigen::Matrix3Xd& points, Vector3d place, Vector3d step, bool flat) {
  const auto room_at = [&](const Vector3d& at) { return (points.colwise() - at).colwise().norm().minCoeff(); };
  double room = room_at(place);
  for (int round = 0; round < 200 && step.maxCoeff() > 1e-4 * room; ++round) {
    Vector3d best = place;
    for (int k = 0; k < 27; ++k) {
      const Vector3d way(k % 3 - 1, k / 3 % 3 - 1, flat ? 0 : k / 9 - 1);
      const Vector3d trial = place + way.cwiseProduct(step);
      const double its_room = room_at(trial);
      if (its_room > room) {
        room = its_room;
        best = trial;
      }
    }
    if (best == place) step /= 2;
    place = best;
  }
  return place;
}

/// Places of a grid that are farther from all points than their neighbours, the farthest first.
std::vector<Vector3d> roomiest_places(const Survey& survey, bool flat) {
  constexpr int kSteps = 9;
  const Vector3d low = survey.sample.rowwise().minCoeff(), high = survey.sample.rowwise().maxCoeff();
  const int layers = flat ? 1 : kSteps;
  const auto place = [&](int x, int y, int z) -> Vector3d {
    const Vector3d share(x / (kSteps - 1.0), y / (kSteps - 1.0), flat ? 0 : z / (kSteps - 1.0));
    return low + share.cwiseProduct(high - low);
  };
  std::vector<double> room(static_cast<std::size_t>(kSteps) * kSteps * static_cast<std::size_t>(layers));
  const auto at = [&](int x, int y, int z) -> double& {
    return room[static_cast<std::size_t>((z * kSteps + y) * kSteps + x)];
  };
  for (int z = 0; z < layers; ++z) {
    for (int y = 0; y < kSteps; ++y) {
      for (int x = 0; x < kSteps; ++x) {
        at(x, y, z) = (survey.sample.colwise() - place(x, y, z)).colwise().norm().minCoeff();
      }
    }
  }
  std::vector<std::pair<double, Vector3d>> found;
  for (int z = flat ? 0 : 1; z < (flat ? 1 : kSteps - 1); ++z) {
    for (int y = 1; y < kSteps - 1; ++y) {
      for (int x = 1; x < kSteps - 1; ++x) {
        bool highest = true;
        for (int step = 0; step < 27 && highest; ++step) {
          const int dz = step / 9 - 1;
          if (flat && dz != 0) continue;
          highest = at(x + step % 3 - 1, y + step / 3 % 3 - 1, z + dz) <= at(x, y, z);
        }
        if (highest) found.emplace_back(at(x, y, z), place(x, y, z));
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Vector3d> places;
  for (std::size_t k = 0; k < std::min(kPlaces, found.size()); ++k) {
    places.push_back(roomiest_near(survey.sample, found[k].second, (high - low) / (kSteps - 1.0), flat));
  }
  return places;
}

/// The same circle or sphere with other centres.
std::vector<ShapeFrame> shifted(ExtremeKind extreme, const ShapeFrame& frame, const Survey& survey) {
  const bool flat = frame.kind == ShapeKind::circle2;
  std::vector<Vector3d> centres;
  if (extreme == ExtremeKind::inscribed) {
    centres = roomiest_places(survey, flat);
  } else if (extreme == ExtremeKind::minimum_zone) {
    centres.push_back(survey.centroid.mean);
    for (int k = 0; k < (flat ? 2 : 3); ++k) {
      for (const double side : {-1., 1.})
        centres.emplace_back(frame.origin + side * survey.extent[k] * survey.directions.col(k));
    }
  }
  std::vector<ShapeFrame> starts;
  for (const Vector3d& centre : centres) {
    ShapeFrame other = frame;
    other.origin = centre;
    if (flat) other.origin.z() = 0;
    if (frame.radius > 0) other.radius = (survey.sample.colwise() - other.origin).colwise().norm().mean();
    starts.push_back(other);
  }
  return starts;
}

}  // namespace

bool may_have_rivals(ShapeKind kind, const Survey& survey, double form) {
  const bool straight = kind == ShapeKind::line2 || kind == ShapeKind::line3;
  const bool in_space = kind == ShapeKind::sphere || kind == ShapeKind::cylinder || kind == ShapeKind::cone;
  return form > kFar * survey.extent[straight ? 0 : in_space ? 2 : 1];
}

std::vector<ShapeFrame> extreme_starts(ExtremeKind extreme, const ShapeFrame& frame, const Survey& survey,
                                       const FitConstraints& constraints) {
  std::vector<ShapeFrame> starts;
  switch (frame.kind) {
    case ShapeKind::line2:
      for (int k = 0; k < 8 && !constraints.direction; ++k) {
        const double turn = std::numbers::pi * k / 8;
        ShapeFrame other = frame;
        other.axes = axes_of_line2({std::cos(turn), std::sin(turn), 0});
        starts.push_back(other);
      }
      return starts;
    case ShapeKind::line3:
    case ShapeKind::plane:
    case ShapeKind::circle3:
      return constraints.direction ? starts : turned(frame, survey, constraints);
    case ShapeKind::circle2:
    case ShapeKind::sphere:
      // With the radius held the centres beside it are starts too; the radius stays.
      starts = shifted(extreme, frame, survey);
      if (constraints.radius) {
        for (ShapeFrame& start : starts) start.radius = *constraints.radius;
      }
      return starts;
    case ShapeKind::cylinder:
    case ShapeKind::cone:
      break;
  }
  starts = start_frames(frame.kind, survey, constraints);
  if (extreme != ExtremeKind::minimum_zone) {
    for (ShapeFrame& start : starts) start.radius = 0;
  }
  return starts;
}

}  // namespace abbe::fits
