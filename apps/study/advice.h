#pragma once

#include <nlohmann/json.hpp>

namespace abbe {

struct StudyResult;

/// What the readings cannot see and what would show it, for the report and for programs.
nlohmann::ordered_json advice_json(const StudyResult& result);

/// The same for people; directions with the same remedy stand together. Conventions are counted only.
void print_advice(const StudyResult& result);

}  // namespace abbe
