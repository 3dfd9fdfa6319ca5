#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"

namespace abbe {

struct Study;
struct StudyResult;

/// Looks for reasons why the result must not be used as it is, and adds what is only to be told to the warnings. Of a
/// result that is not usable it only says where outliers stand together.
/// @param result  with its evaluation at unseen poses
void judge_trust(const Study& study, StudyResult& result);

/// Everything a reader has to be warned of, also what is told elsewhere in the report; without the reasons above.
std::vector<std::string> study_warnings(const Study& study, const StudyResult& result);

/// "misfit, implausible size": the kinds of the reasons, each once.
std::string distrust_kinds(const StudyResult& result);

/// The reasons for programs, each with its kind, text and figures.
nlohmann::ordered_json distrust_json(const StudyResult& result);

/// The identified errors as an errors file holds them, marked if they are not to be trusted. The result is usable.
ErrorsFile identified_errors_file(const Study& study, const StudyResult& result);

/// True if there is no usable result, or one that is distrusted and not accepted. A study without identification never
/// says no.
bool says_no(const Study& study, const StudyResult& result);

}  // namespace abbe
