#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/compensate/program/plane_kinematics.h"
#include "abbe/compensate/program/program_budget.h"
#include "abbe/compensate/program/program_move.h"

namespace abbe {

/// Offsets of the tools, by their numbers: mm, rad for A B C.
using NcToolTable = std::map<int, WordValues>;

/// What a control knows before it runs a program.
struct NcProgramOptions {
  /// Words that the machine has; another one in a program is an error. Order: X Y Z A B C U V W.
  std::array<bool, kAxisWords> words = {true, true, true, true, true, true, false, false, false};
  /// Where the axes stand when the program begins; mm, rad. What is not said here is not known until the program goes
  /// there.
  std::array<std::optional<double>, kAxisWords> start{};
  /// Parameters that are set: work offsets (5221 ...), G92 (5210 ...), G28 (5161 ...), as in a file of LinuxCNC.
  std::map<int, double> parameters;
  bool parameters_in_inches = false;             ///< lengths among them, which are mm otherwise
  std::optional<NcToolTable> tools;              ///< for G43 H
  std::optional<int> tool;                       ///< in the spindle, for G43 without H
  const PlaneKinematics* planes = nullptr;       ///< for G68.2; not owned
  bool tool_centre = false;                      ///< X, Y, Z are the functional point in the workpiece throughout
  bool inches = false;                           ///< G20 in force when the program begins
  bool block_delete = false;                     ///< leave out blocks that begin with a slash
  int decimals_mm = 6;                           ///< of lengths in mm, 0 to 9; one more in inches
  int decimals_deg = 6;                          ///< of angles, 0 to 9
  std::size_t batch = 4096;                      ///< moves that are corrected together
  std::size_t most_moves = 100'000'000;          ///< more are an error: a loop that does not end
  std::size_t most_repeated_moves = 10'000'000;  ///< in loops and subroutines without a new line of what calls them
  std::size_t most_idle_rounds = 1'000'000;      ///< of loops and calls without a move
  ProgramBudget* budget = nullptr;               ///< where it is spent the program is given up; not owned
};

/// What was done with a program.
struct NcProgramResult {
  std::size_t lines = 0;   ///< that were run, those of loops each time
  std::size_t moves = 0;   ///< of which
  std::size_t pieces = 0;  ///< became so many
  /// Rapid moves that could not be corrected, as some axis was not yet where the program had sent it; and the first's
  /// line.
  std::size_t uncorrected_moves = 0;
  std::size_t first_uncorrected_line = 0;
  /// First move in a work offset (G54-G59.3) that neither the parameters nor the program have said, so that it was
  /// taken for zero; 0: none.
  std::size_t first_assumed_offset_line = 0;
  /// What was spent when the program was given up: what was written until then is no program.
  ProgramBudget::Spent spent = ProgramBudget::Spent::nothing;
  std::size_t given_up_line = 0;
};

/// Runs an NC program (RS274/NGC as LinuxCNC reads it, ISO 6983), has its moves corrected and writes it again.
///
/// See docs/nc-programs.md for what is read, kept and refused. The program may be longer than the memory: what was read
/// is forgotten, what is corrected is written, both in one pass.
///
/// @param file    name for messages
/// @param write   takes the corrected program piece by piece
/// @param read_to if given: told how far the text was read, in bytes, now and then
/// @throws InputError for what cannot be handled, with line and word
NcProgramResult correct_nc_program(std::string_view text, const std::string& file, const NcProgramOptions& options,
                                   MoveCorrector& corrector, const std::function<void(std::string_view)>& write,
                                   const std::function<void(std::size_t)>& read_to = {});

/// Parameters of a LinuxCNC parameter file (.var): a number and a value in every line.
/// @throws InputError
std::map<int, double> read_nc_parameters(const std::filesystem::path& path);
std::map<int, double> parse_nc_parameters(std::string_view text, const std::string& file);

/// Tools of a LinuxCNC tool table: "T1 P1 Z50.0 D6 ;comment" in every line.
/// @param in_inches  lengths of the table, which are mm otherwise
/// @throws InputError
NcToolTable read_nc_tools(const std::filesystem::path& path, bool in_inches = false);
NcToolTable parse_nc_tools(std::string_view text, const std::string& file, bool in_inches = false);

}  // namespace abbe
