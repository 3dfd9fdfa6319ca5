#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace abbe {

struct StudyResult;
struct UnseenPoses;

/// What the readings cannot see and what would show it, for the report and for programs.
nlohmann::ordered_json advice_json(const StudyResult& result);

/// The same for people; directions with the same remedy stand together. Conventions and matters of the datum are
/// counted only.
/// @param shows_all  option to be named where only the first few of a remedy are printed; null: every direction
std::string advice_text(const StudyResult& result, const char* shows_all);

/// Directions that the readings leave open, but on which the volumetric error does not depend, become a matter of the
/// datum.
void tell_datum_apart(StudyResult& result, const UnseenPoses& unseen);

}  // namespace abbe
