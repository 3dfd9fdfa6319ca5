/// Least-squares fits of 1,000,000 points against the same fits written straightforwardly with Eigen, in one run. The
/// baseline is given a start near the answer, the library finds its own. The exit code is 1 if a shape is not faster on
/// one thread or the answers differ.

#include <Eigen/Dense>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "abbe/geometry/fits/shape_fit.h"
#include "eigen_fit.h"

namespace abbe::benchmarks {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr Index kPoints = 1000000;
constexpr double kNoise = 0.005;  // mm

/// Points in the order of a scan that runs along lines, with noise across the shape.
Matrix3Xd scanned(const Shape& shape, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, kNoise);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const bool flat = shape.kind == ShapeKind::line2 || shape.kind == ShapeKind::circle2;
  Vector3d w = shape.direction, u = flat ? Vector3d(Vector3d::UnitX()) : w.unitOrthogonal(), v = w.cross(u);
  if (shape.kind == ShapeKind::sphere) w = Vector3d::UnitZ(), u = Vector3d::UnitX(), v = Vector3d::UnitY();
  Matrix3Xd points(3, kPoints);
  for (Index i = 0; i < kPoints; ++i) {
    const double t = 2 * std::numbers::pi * static_cast<double>(i % 1000) / 1000;
    const double z = 30 * (static_cast<double>(i) / kPoints * 2 - 1), e = noise(generator), f = noise(generator);
    const Vector3d out = std::cos(t) * u + std::sin(t) * v;
    Vector3d p = Vector3d::Zero();
    switch (shape.kind) {
      case ShapeKind::line2:
        p = z * w + e * Vector3d(-w.y(), w.x(), 0);
        break;
      case ShapeKind::line3:
        p = z * w + e * u + f * v;
        break;
      case ShapeKind::plane:
        p = z * u + 20 * uniform(generator) * v + e * w;
        break;
      case ShapeKind::circle2:
        p = (shape.radius + e) * Vector3d(std::cos(t), std::sin(t), 0);
        break;
      case ShapeKind::circle3:
        p = (shape.radius + e) * out + f * w;
        break;
      case ShapeKind::sphere:
        p = (shape.radius + e) * (std::sqrt(1 - z * z / 900) * out + z / 30 * w);
        break;
      case ShapeKind::cylinder:
        p = (shape.radius + e) * out + z * w;
        break;
      case ShapeKind::cone: {
        const double c = std::cos(shape.half_angle), s = std::sin(shape.half_angle);
        p = (shape.radius + z * s / c) * out + z * w + e * (c * out - s * w);
        break;
      }
    }
    points.col(i) = shape.point + p;
  }
  return points;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool compare(ShapeKind kind, std::mt19937_64& generator) {
  Shape shape;
  shape.kind = kind;
  const bool flat = kind == ShapeKind::line2 || kind == ShapeKind::circle2;
  shape.point = Vector3d(120, -40, flat ? 0 : 77);
  shape.direction = flat ? Vector3d(0.6, 0.8, 0) : Vector3d(0.2, 0.3, 0.93).normalized();
  if (kind == ShapeKind::circle2) shape.direction = Vector3d::UnitZ();
  if (kind >= ShapeKind::circle2) shape.radius = 25;
  if (kind == ShapeKind::cone) shape.half_angle = 0.3;
  const Matrix3Xd points = scanned(shape, generator);
  Shape start = shape;
  start.point += Vector3d(0.2, -0.1, flat ? 0 : 0.1);
  start.radius *= 1.01;
  if (flat && kind == ShapeKind::line2) start.direction = Vector3d(0.61, 0.79, 0).normalized();
  if (!flat) start.direction = (start.direction + Vector3d(0.01, -0.01, 0)).normalized();

  double baseline = 1e9, one = 1e9, two = 1e9;
  EigenFit expected;
  ShapeFit fit;
  for (int repetition = 0; repetition < 5; ++repetition) {
    auto begin = std::chrono::steady_clock::now();
    expected = eigen_fit(start, points);
    baseline = std::min(baseline, seconds_since(begin));
    FitOptions options;
    for (options.threads = 1; options.threads <= 2; ++options.threads) {
      begin = std::chrono::steady_clock::now();
      fit = least_squares_fit(kind, points, options);
      double& best = options.threads == 1 ? one : two;
      best = std::min(best, seconds_since(begin));
    }
  }
  const double rms = std::sqrt(expected.squares / kPoints);
  const bool same = fit.ok() && std::abs(fit.rms - rms) < 1e-11 &&
                    std::abs(fit.shape.radius - expected.shape.radius) < (kind == ShapeKind::cone ? 1e9 : 1e-8);
  const bool met = same && one < baseline;
  std::printf("%-9s %10.1f %5d %11.1f %11.1f %5d %9.1f %8.1f   %s\n", shape_name(kind), 1e3 * baseline,
              expected.iterations, 1e3 * one, 1e3 * two, fit.iterations, baseline / one, baseline / two,
              met    ? "met"
              : same ? "MISSED"
                     : "ANSWERS DIFFER");
  return met;
}

}  // namespace

int run() {
  std::printf("1,000,000 points, ms\n%-9s %10s %5s %11s %11s %5s %9s %8s\n", "shape", "Eigen", "steps", "one thread",
              "two threads", "passes", "ratio", "ratio 2");
  std::mt19937_64 generator(7);
  bool met = true;
  for (const ShapeKind kind : {ShapeKind::line2, ShapeKind::line3, ShapeKind::plane, ShapeKind::circle2,
                               ShapeKind::circle3, ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone}) {
    met = compare(kind, generator) && met;
  }
  return met ? 0 : 1;
}

}  // namespace abbe::benchmarks

int main() { return abbe::benchmarks::run(); }
