#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace abbe {

/// Largest size that a report with recommended thinning stays under, bytes; see docs/report-data.md.
inline constexpr std::size_t kReportSizeLimit = 3'000'000;

/// One self-contained HTML page that shows results; it needs no network and works from a file.
///
/// Computes nothing: the page draws what the data hold, and a section without data is absent. Text in the data cannot
/// end the element that holds it, whatever it contains; text that is not UTF-8 gets replacement characters.
/// @param data  "abbe-report/1" as docs/report-data.md describes it; units are in the keys
/// @throws std::invalid_argument if data is not an object with "format": "abbe-report/1" and a text "title", or if it
///         holds a number that is not finite (the message names the key)
std::string report_page(const nlohmann::json& data);

}  // namespace abbe
