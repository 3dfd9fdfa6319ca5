#pragma once

namespace abbe {

/// Machine file of two axes: X carries the workpiece, Z the tool.
inline constexpr const char* kTableXColumnZ =
    "name = \"m\"\nchain = \"w X' b Z t\"\n[axis.X]\ntravel_mm = [0, 1400]\n[axis.Z]\ntravel_mm = [0, 600]\n";

}  // namespace abbe
