#pragma once

namespace abbe {

/// Machine file of two axes: X carries the workpiece, Z the tool.
inline constexpr const char* kTableXColumnZ =
    "name = \"m\"\nchain = \"w X' b Z t\"\n[axis.X]\ntravel_mm = [0, 1400]\n[axis.Z]\ntravel_mm = [0, 600]\n";

/// Part of a set-up of a laser tracker: three reflectors that are not on a line.
inline constexpr const char* kThreeReflectors = R"([[setup.reflector]]
name = "R1"
offset_mm = [60, 0, -150]
[[setup.reflector]]
name = "R2"
offset_mm = [0, 80, -250]
[[setup.reflector]]
name = "R3"
offset_mm = [-70, -30, -100]
)";

}  // namespace abbe
