#pragma once

#include <string>

#include "verify/verify_job.h"

namespace abbe {

/// The page of a verification, whole: docs/verify.md, docs/report-data.md (`verification`).
std::string verify_page(const VerifyOptions& options, const VerifyResult& result);

}  // namespace abbe
