#pragma once

#include <nlohmann/json_fwd.hpp>

namespace abbe {

struct Study;
struct StudyResult;

/// Prints the readings that the fit takes for outliers, the worst first, with the names of their points in the input.
/// @param shows_all  option to be named where only the first few are printed; null: all of them
void print_outliers(const Study& study, const StudyResult& result, const char* shows_all);

/// The same for programs, at most a thousand: `outlier_list` of summary.json.
nlohmann::ordered_json outliers_json(const Study& study, const StudyResult& result);

}  // namespace abbe
