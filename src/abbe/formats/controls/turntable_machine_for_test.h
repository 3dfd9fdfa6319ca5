#pragma once

// For tests: a turntable C on a slide X, a column with Z; chain w C' X' b Z t.
#include "abbe/formats/machine/machine_file.h"

namespace abbe::test {

inline const char* const kEndlessTurntable =
    "name = \"m\"\nchain = \"w C' X' b Z t\"\n[axis.C]\nendless = true\n[axis.X]\ntravel_mm = [0, 1400]\n"
    "[axis.Z]\ntravel_mm = [0, 600]\n";
inline const char* const kOneTurnTurntable =
    "name = \"m\"\nchain = \"w C' X' b Z t\"\n[axis.C]\ntravel_deg = [0, 360]\n[axis.X]\ntravel_mm = [0, 1400]\n"
    "[axis.Z]\ntravel_mm = [0, 600]\n";

inline Machine endless_turntable() { return parse_machine(kEndlessTurntable, "m.toml"); }
inline Machine one_turn_turntable() { return parse_machine(kOneTurnTurntable, "m.toml"); }

}  // namespace abbe::test
