#pragma once

// For plan_text and plan_page: what a plan says about states.
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/study/planning/planning.h"

namespace abbe {

/// Conditions, readings at each, uncertainty over the states, sensors; nothing for a plan without states.
std::string planned_states_text(const Study& study, const StudyPlan& result);

/// Key `states`; nothing for a plan without states.
void add_planned_states(const Study& study, const StudyPlan& result, nlohmann::ordered_json& json);

/// Tables of the page, as report_page() takes them.
nlohmann::json planned_states_tables(const StudyPlan& result);

/// Heads ("ambient_degC,") and values of the columns of states of a reading; empty without states.
std::string state_heads_of_plan(const Study& study, const StudyPlan& result);
std::string states_of_planned_reading(const StudyPlan& result, std::size_t reading);

/// "not determined at these states (2 directions open, most of all in EXX*ambient[P1])": for a plan that leaves open
/// what errors do where they are used.
std::string open_states_words(const StudyPlan& result);

/// "hall_degC = 18; hall_degC = 24", or the times of a course.
std::string conditions_list(const StudyPlan& result, const std::vector<std::size_t>& conditions);
std::string condition_words(const StudyPlan& result, std::size_t condition);
nlohmann::ordered_json states_json(const Study& study, const std::vector<double>& states);

/// Against as many readings at plain states; nothing where none were compared.
std::string plain_states_text(const StudyPlan& result);
nlohmann::ordered_json plain_states_json(const Study& study, const StudyPlan& result, const PlainStates& plain);
nlohmann::json plain_states_table(const StudyPlan& result);

}  // namespace abbe
