#pragma once

// Internal to study: residuals of readings that stay in their files.
#include <cstdint>

#include "abbe/geometry/numbered_work.h"
#include "abbe/instruments/observations.h"

namespace abbe {

/// What is said of the residuals of all readings after the fit, without keeping anything of each reading. Whole numbers
/// are doubles, as they are sent.
struct NormTally {
  double beyond = 0;   ///< number of readings whose residual is larger than the limit
  double largest = 0;  ///< norm, standard uncertainties
  double reading = 0;  ///< number of the first reading that has it

  void take(const NormTally& other) {
    beyond += other.beyond;
    if (other.largest > largest || (other.largest == largest && other.reading < reading)) {
      largest = other.largest;
      reading = other.reading;
    }
  }
};

/// Norms of the residuals of all readings at the present point of the observations, as numbered work.
/// @param limit        in standard uncertainties
/// @param fingerprint  of readings and estimates
NormTally tally_norms(const Observations& observations, double limit, std::uint64_t fingerprint, int threads,
                      const WorkDriver& driver);

}  // namespace abbe
