#pragma once

#include <string>

namespace abbe::test {

/// A file of examples/: "laser_engraver/sections.csv".
inline std::string example_file(const std::string& name) { return ABBE_SOURCE_DIR "/examples/" + name; }

}  // namespace abbe::test
