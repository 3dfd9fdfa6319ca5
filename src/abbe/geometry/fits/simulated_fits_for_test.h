#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "abbe/geometry/fits/extreme_fit.h"
#include "abbe/geometry/fits/robust_fit.h"
#include "abbe/geometry/fits/shape_points_for_test.h"
#include "abbe/geometry/fits/simulated_shapes_for_test.h"

/// Fits of simulated sets, each answer judged by another way than that by which it was found.
namespace abbe::test {

/// Standard uncertainty (see SimulatedSet) up to which no fit may refuse a set; fits refuse at 0.2 rad or 0.25 of the
/// radius, and the scatter of three residuals may be several times the noise.
inline constexpr double kDetermined = 0.03;

std::string words(const SimulatedSet& set, const ShapeFit& fit);

/// Of a distance from a shape as plain data in the frame of the points, mm.
double rounding_of(const SimulatedSet& set);

/// [points] mm
Eigen::VectorXd distances_from(const Shape& shape, const Eigen::Matrix3Xd& points);

/// Of a robust fit: there is an answer, and it is stationary with its weights.
void judge_robust(const SimulatedSet& set, const ShapeFit& fit);

/// Fits `count` sets of each shape and judges every answer.
void simulate_least_squares(int count, std::uint64_t seed);
void simulate_extreme(ExtremeKind extreme, int count, std::uint64_t seed);
/// Sets of half the uncertainty: a scatter above 0.15 of the extent is no consensus, whatever the covariance says.
void simulate_robust(int count, std::uint64_t seed);

}  // namespace abbe::test
