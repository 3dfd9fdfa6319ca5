#pragma once

// A machine and its errors from files, and a mistake in one:
//
//   #include <abbe/formats/machine/errors_file.h>
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/formats/text/input_error.h>
//
//   #include <cstdio>
//
//   int main() {
//     const abbe::Machine mill = abbe::read_machine("examples/machines/three-axis-mill.machine.toml");
//     const abbe::ErrorsFile known = abbe::read_errors("examples/compensate/mill.errors.toml", mill);
//     const abbe::Axis& x = mill.axes[mill.find_axis("X")];
//     std::printf("%s: X from %.0f to %.0f mm\n", mill.chain().c_str(), x.travel_min, x.travel_max);
//     for (const abbe::LocationError& error : known.errors.locations) {
//       std::printf("%s = %.0f urad, standard uncertainty %.0f urad\n",
//                   abbe::location_error_name(mill, error.axis, error.component).c_str(), 1e6 * error.value,
//                   1e6 * error.standard_uncertainty);
//     }
//     const char* wrong = "name = \"saw\"\nchain = \"w X' b Z t\"\n[axis.X]\ntravel_mm = [760, 0]\n";
//     try {
//       abbe::parse_machine(wrong, "saw.toml");
//     } catch (const abbe::InputError& error) {
//       std::printf("%s\n", error.what());
//     }
//     return 0;
//   }
//
// It prints:
//
//   w X' Y' b Z t: X from 0 to 760 mm
//   EC0Y = 35 urad, standard uncertainty 2 urad
//   EB0Z = -22 urad, standard uncertainty 2 urad
//   saw.toml:4:1: axis.X.travel_mm: the first limit is not below the second; expected [smallest, largest] command
//
// formats holds every file that is read or written:
//   machine/                            machines, errors (errors_file.h), maps, placements, transforms
//   study/study_file.h                  studies: instruments, plans, what is identified
//   readings/measurement_file.h         readings of instruments; scans beside it
//   nc/nc_program.h, controls/          NC programs; tables of controls
//   shapes/mesh_file.h                  meshes, STEP, point clouds, curves
//   text/input_error.h, files/          messages, units, numbers, CSV and TOML; writing files whole or not at all

#include <filesystem>
#include <string>

#include "abbe/machine/machine.h"

namespace abbe {

/// Machine from a `*.machine.toml` file; the format is described in docs/formats.md. @throws InputError
Machine read_machine(const std::filesystem::path& path);
/// The same from text. @param file  name for messages
Machine parse_machine(const std::string& text, const std::string& file);

/// Text of a machine file without comments; parse_machine() gives back the same machine.
std::string machine_text(const Machine& machine);

/// Commented machine file for a chain such as "w C' X' b Z t", to be filled in by a person: `abbe new`. @throws
/// InputError
std::string commented_machine_file(const std::string& chain);

}  // namespace abbe
