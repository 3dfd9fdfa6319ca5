#pragma once

namespace abbe {

/// What the process returns.
enum ExitCode {
  kDone = 0,          ///< done
  kNegative = 1,      ///< the computation says no: not converged, rank deficient, out of range or of tolerance
  kBadInput = 2,      ///< a file or an option is wrong
  kInternalError = 3  ///< a bug
};

}  // namespace abbe
