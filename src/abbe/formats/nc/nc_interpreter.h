#pragma once

// Internal to formats: runs an NC program.
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "abbe/formats/nc/nc_cycles.h"
#include "abbe/formats/nc/nc_flow.h"
#include "abbe/formats/nc/nc_moves.h"
#include "abbe/formats/nc/nc_origin.h"
#include "abbe/formats/nc/nc_pass_through.h"
#include "abbe/formats/nc/nc_state.h"
#include "abbe/formats/nc/nc_system_parameters.h"
#include "abbe/formats/nc/nc_writer.h"

namespace abbe {

/// Runs a program block by block as LinuxCNC does and gives moves and what stands between them to a writer.
///
/// Order within a block: comments, feed mode, feed, speed and tool, M codes before the motion, dwell, plane, units,
/// tool length, work offset, path mode, distance mode, retract mode, offsets and references, motion, stop. Source:
/// LinuxCNC, G-code overview, "Order of execution".
class NcInterpreter {
 public:
  NcInterpreter(std::string_view text, const std::string& file, const NcProgramOptions& options, NcWriter& writer);

  /// @returns lines that were run
  std::size_t run(const std::function<void(std::size_t)>& read_to);

  std::size_t line() const { return line_; }  ///< that is run
  std::size_t first_assumed_offset_line() const { return moves_.first_assumed_offset_line(); }

 private:
  void run_flow();
  void execute();
  void run_subprogram_code();
  void apply_assignments();
  void set_modes();
  void set_plane();
  void set_tool_length();
  void set_reference();
  void move(NcCode motion);
  /// Program values count from the offsets in force.
  void update_frame();
  /// M0, M1, M2, M30, M60, M98 or M99 of the block, or kNoCode.
  double stop_code() const;

  std::string_view text_;
  const std::string& file_;
  const NcProgramOptions& options_;
  NcWriter& writer_;
  NcParameters parameters_;
  NcExpression expression_;
  NcFlow flow_;
  NcBlockReader reader_;
  NcCodedBlock block_;
  NcState state_;
  NcSystemParameters system_parameters_;
  NcPassThrough pass_;
  NcMoves moves_;
  NcCycles cycles_;
  NcOriginCodes origin_;

  std::size_t line_ = 0;
  std::string plane_comment_;
};

}  // namespace abbe
