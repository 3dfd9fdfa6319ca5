#pragma once

#include <nlohmann/json_fwd.hpp>

namespace abbe {

struct StudyResult;
struct UnseenPoses;

/// What the readings cannot see and what would show it, for the report and for programs.
nlohmann::ordered_json advice_json(const StudyResult& result);

/// The same for people; directions with the same remedy stand together. Conventions and matters of the datum are
/// counted only.
/// @param all  every direction; else the first few of each remedy
void print_advice(const StudyResult& result, bool all);

/// Directions that the readings leave open, but on which the volumetric error does not depend, become a matter of the
/// datum.
void tell_datum_apart(StudyResult& result, const UnseenPoses& unseen);

}  // namespace abbe
