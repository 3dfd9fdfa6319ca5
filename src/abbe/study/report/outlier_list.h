#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace abbe {

struct Study;
struct StudyResult;

/// The readings that the fit takes for outliers, the worst first, with the names of their points in the input.
/// @param shows_all  option to be named where only the first few are printed; null: all of them
std::string outliers_text(const Study& study, const StudyResult& result, const char* shows_all);

/// The same for programs, at most a thousand: `outlier_list` of summary.json.
nlohmann::ordered_json outliers_json(const Study& study, const StudyResult& result);

}  // namespace abbe
