#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/identify/identify.h"
#include "abbe/identify/planning_candidates.h"
#include "abbe/identify/problem.h"

namespace abbe {

/// Readings that could be added to a problem, as rows of their whitened Jacobian.
struct PossibleMeasurement {
  std::string words;              ///< "readings with another reflector that is not on their line"
  PlanningCandidates::Rows rows;  ///< [rows, p + own]: columns of the estimates, then of unknowns of its own
  std::size_t own = 0;            ///< unknowns that the problem does not have: the pose of another station
};

/// What a direction that the readings do not determine is.
enum class AdviceKind {
  not_measured,  ///< some further measurement would determine it: lack of data
  weak,          ///< seen, but its uncertainty is above the typical size of errors
  convention,    ///< nothing that could be measured would determine it: the same machine is described in several ways
  datum,         ///< it moves the workpiece as a whole or nothing at all: the volumetric error does not depend on it
  set_up         ///< it concerns unknowns of the set-up alone; the machine's errors do not depend on it
};

/// What one direction of the parameters means for the person who measured.
struct Advice {
  AdviceKind kind = AdviceKind::not_measured;
  std::vector<std::size_t> parameters;  ///< entries of the estimates that the direction mixes, largest first
  std::string text;                     ///< what is not seen, or only weakly
  std::string words;                    ///< these parameters in words of ISO 230
  std::string remedy;                   ///< which measurement would show it, or why none would
  bool unseen = true;                   ///< false: seen, but hardly
  bool shown = false;                   ///< a trial with simulated readings showed that the remedy helps
  double factor = 0;                    ///< seen, but hardly: by how much the remedy lowers the standard uncertainty
};

/// For programs: "not measured", "weak", "convention", "datum", "set-up".
const char* kind_text(AdviceKind kind);

struct AdviceOptions {
  /// A direction is weak if its standard uncertainty is above this part of the typical size of errors.
  double weak = 1;
  double typical_length = 0.01;  ///< mm, size of an error motion or a location error of a usual machine
  double typical_angle = 5e-5;   ///< rad
};

/// What could be measured additionally, easiest first: with the instruments of the problem where they stand (other
/// positions of their axes, a bar in other directions or a longer one, another place of a ball, sphere, optic or
/// reflector, another station), then with further instruments at sensible places of the machine: ball bar, R-test,
/// polygon prism, level, laser interferometer with and without optical square, laser tracker. Unknowns of what is set
/// up anew are unknowns of its own. Derivatives at errors of zero and at the present values of the set-up's unknowns.
std::vector<PossibleMeasurement> possible_measurements(const Problem& problem);

/// Says for every direction fixed by the gauge, and for every one that is seen only weakly, which of the possible
/// measurements would show it.
///
/// Each is tried: its rows are added to the information, and the direction has to become separable, with errors of
/// typical size showing by more than the noise (weak ones: the variance has to fall to a quarter). Directions that all
/// of them together leave open are conventions, and their part is left out of the others. A direction held by a prior
/// alone is said to be so. Those of the gauge come first, in its order; whether they are a matter of the datum is not
/// found here (verify/parts/determined_part.h).
/// @param problem  observations stand at the estimates, and do so afterwards
std::vector<Advice> unseen_advice(const Problem& problem, const Identification& identification,
                                  const std::vector<PossibleMeasurement>& possible, const AdviceOptions& options = {});

}  // namespace abbe
