#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/verify/unmodelled_errors.h"

namespace abbe {

struct Study;
struct StudyResult;

/// Errors that the same measurement would show.
struct NotIdentifiedRemedy {
  std::vector<std::string> errors;
  bool by_readings = false;  ///< the readings at hand show them once they are identified too
  std::string remedy;        ///< else the measurement that would; empty: none of those tried
};

/// Errors of the machine on which the volumetric error depends and which the study takes as zero: the stated
/// uncertainties are those of the identified errors alone.
struct NotIdentified {
  std::vector<UnmodelledError> errors;
  std::vector<std::string> names;  ///< of `errors`: "EXY", "EC0Y"
  double usual = 0;                ///< volumetric error that errors of usual size there make, root mean square, mm
  double actual = 0;               ///< simulation: what the true ones make after the best fit of the datum, mm
  std::vector<NotIdentifiedRemedy> remedies;
};

/// Those that a model of errors does not hold, at random poses over where the model is known; without remedies.
NotIdentified find_not_in_model(const Study& study, const ErrorSet& model);

/// @param result  usable, with its campaign
/// @param advice  false: without the remedies
NotIdentified find_not_identified(const Study& study, const StudyResult& result, bool advice = true);

/// "EXX, all error motions of Y, squareness EC0Y": short.
std::string not_identified_names(const Study& study, const NotIdentified& found);

/// One or two sentences for the warnings. @pre there are such errors
std::string not_identified_text(const Study& study, const StudyResult& result);

/// Remark next to an uncertainty that does not cover them.
inline constexpr const char* kIdentifiedErrorsOnly = "identified errors only";

nlohmann::ordered_json not_identified_json(const Study& study, const StudyResult& result);

/// Which measurement would show them, on stdout.
std::string not_identified_remedies_text(const StudyResult& result);

}  // namespace abbe
