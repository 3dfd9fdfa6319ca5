#pragma once

// Internal to identify: mean and covariance of samples, which several processes find together.
#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "abbe/geometry/numbered_work.h"

namespace abbe {

struct SampleMoments {
  Eigen::VectorXd mean;        ///< [p]
  Eigen::MatrixXd covariance;  ///< [p, p]
};

/// Moments of blocks of samples, combined in their order: as exact as with the mean of all samples, which is not needed
/// before. Source: Chan, Golub and LeVeque, Algorithms for computing the sample variance, The American Statistician 37
/// (1983) 242.
/// @param samples      [p, n], n >= 2, the same in every process
/// @param threads      as NumberedWork::threads
/// @param fingerprint  of what the samples depend on
SampleMoments sample_moments(const Eigen::MatrixXd& samples, int threads, const WorkDriver& driver,
                             const std::function<std::uint64_t()>& fingerprint);

}  // namespace abbe
