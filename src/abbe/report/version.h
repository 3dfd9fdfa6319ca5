#pragma once

namespace abbe {

/// Version of Abbe, "0.1.0": stands in everything that is written.
const char* version_text();

}  // namespace abbe
