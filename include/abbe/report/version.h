#pragma once

namespace abbe {

/// Version of Abbe, "0.2.0": stands in everything that is written.
const char* version_text();
/// Day on which it was released, "2026-11-26".
const char* release_date_text();

}  // namespace abbe
