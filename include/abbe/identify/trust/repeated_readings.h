#pragma once

#include <string>

#include "abbe/identify/trust/reading_facts.h"
#include "abbe/instruments/observations.h"

namespace abbe {

/// Pairs of readings of one set-up at the same pose, with the same labels and inputs.
struct RepeatedReadings {
  std::size_t pairs = 0;
  std::size_t identical = 0;          ///< pairs whose measured numbers agree in every digit
  double expected = 0;                ///< of these by the stated uncertainties and the digits that are written
  double probability = 1;             ///< of so many identical pairs or more
  std::size_t first = 0, second = 0;  ///< readings of the first identical pair, if there is one
  bool are_copies() const;            ///< too many for independent readings
};

/// Counts readings that repeat an earlier one to the last digit: duplicated rows, one reading used twice.
///
/// Two readings with standard uncertainty u that are written in steps of q agree with probability q / (2 sqrt(pi) u).
/// The step is that of the decimals in mm, inch, rad, deg or arcsec, times five because some instruments count in
/// fives.
/// @param observations  stand anywhere; only the ratio of deviation to residual is used
RepeatedReadings repeated_readings(const Observations& observations, const ReadingFacts& facts);

/// A sentence about copies for the user.
std::string copies_text(const RepeatedReadings& repeated, const ReadingFacts& facts);

}  // namespace abbe
