#pragma once

// Internal to formats: runs an NC program.
#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/nc/nc_flow.h"
#include "abbe/formats/nc/nc_modes.h"
#include "abbe/formats/nc/nc_writer.h"

namespace abbe {

/// Runs a program block by block as LinuxCNC does and gives moves and what stands between them to a writer.
///
/// Order within a block: comments, feed mode, feed, speed and tool, M codes before the motion, dwell, plane, units,
/// tool length, work offset, path mode, distance mode, retract mode, offsets and references, motion, stop. Positions
/// here are mm and degrees, as the control has them: program value + work offset + G92 + tool length. Source: LinuxCNC,
/// G-code overview, "Order of execution".
class NcInterpreter final : public NcSystemValues {
 public:
  NcInterpreter(std::string_view text, const std::string& file, const NcProgramOptions& options, NcWriter& writer);

  /// @returns lines that were run
  std::size_t run(const std::function<void(std::size_t)>& read_to);

  std::size_t line() const { return line_; }  ///< that is run
  std::size_t first_assumed_offset_line() const { return first_assumed_offset_line_; }

  bool numbered(int number, double& value) const override;
  bool named(std::string_view name, double& value) const override;

 private:
  using Words = std::array<double, kAxisWords>;
  /// A position of which some words are known.
  struct Reference {
    Words value{};
    std::uint32_t known = 0;
  };

  // nc_interpreter.cpp
  void take_parameters();
  void execute();
  /// The code of motion that this block carries out, by its own word or by the one in force.
  NcCode motion_that_runs() const;
  void check_words() const;
  void check_missing_words() const;
  void apply_assignments();
  bool ends_program() const;

  // nc_words.cpp: what passes to the control
  /// @param unit_changes  by a word of this block
  void pass_block(bool has_motion, bool unit_changes = false);
  /// The block with its code of offsets and axis words said in another way.
  /// @param replaced  letters of further words that belong to the code
  void pass_block_with(const std::string& code, std::string_view replaced);
  void note_what_was_said(bool has_motion);
  void append_words(std::uint64_t consumed);
  void append_word(std::string& text, const NcWord& word) const;
  void pass_comments(bool as_lines);
  std::string resolved_comment(std::string_view comment) const;
  void pass_assignments();

  // nc_offsets.cpp
  void set_feed();
  void set_modes();
  void set_tool_length();
  void set_origin(bool moves);
  void set_axis_offset(bool moves);
  void write_axis_offset();
  void update_frame();
  Words offsets_in_force() const;
  void set_tool_centre(bool on);
  double unit(std::size_t axis) const;
  const Words& tool_offset(const NcWord& word);

  // nc_moves.cpp
  void move_by_word(NcCode motion);
  void go_to_reference();
  Words ends(std::uint32_t& known) const;
  void rapid(const Words& end, std::uint32_t known);
  void straight(const Words& end, std::uint32_t known, SpindleMove spindle = SpindleMove::none);
  void thread(NcCode motion);
  void arc(NcCode motion);
  void arc_by_centre(ProgramMove& move, const Words& end, std::size_t first, std::size_t second);
  void arc_by_radius(ProgramMove& move, const Words& end, std::size_t first, std::size_t second);
  void check_feed(const char* what);
  void emit(ProgramMove& move, const Words& end, std::uint32_t known);
  [[noreturn]] void fail_unknown(std::uint32_t words, const std::string& why) const;

  // nc_planes.cpp: tilted planes
  void check_plane_words() const;
  void set_plane();
  void turn_to_plane();
  /// From here on position_ has X, Y, Z of the plane (positions of the axes).
  void enter_plane();
  void leave_plane();
  Words axes_of_plane(const Words& words) const;
  void turn_arc_to_axes(ProgramMove& move) const;
  WordValues radians(const Words& words) const;
  bool words_are_points() const;

  // nc_cycles.cpp
  void cycle(NcCode motion);
  void drill(NcCode motion, const Words& above, double bottom, double clear, std::size_t depth);

  std::string_view text_;
  const std::string& file_;
  const NcProgramOptions& options_;
  NcWriter& writer_;
  NcParameters parameters_;
  NcExpression expression_;
  NcFlow flow_;
  NcBlockReader reader_;
  NcBlock block_;
  NcCodes codes_;
  NcModes modes_;

  std::uint32_t machine_words_ = 0;  ///< bits of the axis words that the machine has
  Words position_{};
  std::uint32_t known_ = 0;
  std::size_t line_ = 0;
  std::array<Words, 9> systems_{};  ///< work offsets G54 to G59.3
  std::array<bool, 9> system_is_said_{};
  std::size_t first_assumed_offset_line_ = 0;
  Words axis_offset_{};              ///< G92, G52 in force
  Words stored_axis_offset_{};       ///< 5211 ...
  Words tool_offset_{};              ///< G43
  Words offset_{};                   ///< sum of those in force; X, Y, Z zero while a plane is tilted
  std::array<Reference, 2> home_{};  ///< G28, G30
  NcToolTable tools_;
  std::optional<int> tool_, selected_tool_;
  bool overrides_ = true;     ///< M48, not M49
  double spindle_speed_ = 0;  ///< S
  int spindle_ = 0;           ///< 3 or 4: turns by M3 or M4; 0: is not known to turn
  std::string path_words_;    ///< "G64 P0.1", for after a cycle

  /// G68.2: place in the workpiece = origin + rotation * X, Y, Z of the plane, each in the directions of X, Y, Z words.
  struct Tilt {
    bool on = false;
    bool counts = false;  ///< position_ has X, Y, Z of the plane
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    /// Positions of the axes X, Y, Z = axes_from_plane * (X, Y, Z of the plane) + at_zero, as the others stand, mm.
    Eigen::Matrix3d axes_from_plane = Eigen::Matrix3d::Identity();
    Eigen::Vector3d at_zero = Eigen::Vector3d::Zero();
  };
  Tilt tilt_;
  Words machine_position_{};  ///< of the control while position_ counts in a plane
  std::string plane_comment_;

  /// Of the last block of a cycle, for the next one of the same code.
  struct Cycle {
    NcCode code = kNoCode;
    double bottom = 0, r = 0, dwell = 0, step = 0;  ///< as written
    double level = 0;                               ///< mm, of the control
  };
  Cycle cycle_;
};

}  // namespace abbe
