#pragma once

#include <string>

#include "abbe/study/study_result.h"

namespace abbe {

/// The result of a study for people: verdict, key figures, identified values, gauge, warnings.
/// @param shows_all  option that shows every identified value, outlier and direction not seen, to be named where only
///                   the first of them are printed; null: print all
std::string study_text(const Study& study, const StudyResult& result, const char* shows_all);

/// Every identified parameter with its standard uncertainty in um, urad or um/m, a line each below a heading.
std::string parameters_text(const StudyResult& result);

}  // namespace abbe
