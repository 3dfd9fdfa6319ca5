#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/study/verification/verification.h"

namespace abbe {

/// Data of the page of a verification: docs/report-data.md (`verification`).
nlohmann::json verification_page_data(const Verification& result);

/// The page itself, HTML. docs/verify.md.
std::string verification_page(const Verification& result);

}  // namespace abbe
