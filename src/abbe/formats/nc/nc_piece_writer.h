#pragma once

// Internal to formats: corrected moves as blocks of a program.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/program/program_move.h"
#include "abbe/formats/nc/nc_program.h"

namespace abbe {

/// How positions are said in a program: program value = (control's value - offset) / unit.
struct NcProgramFrame {
  std::array<double, kAxisWords> offset{};  ///< mm, degrees
  bool inches = false;
};

/// Changes of what the control has in force, by lines between moves.
struct NcControlEvents {
  bool forget_feed = false, said_units = false, said_absolute = false, sets_mode = false, forget_linear = false;
  FeedMode mode = FeedMode::per_minute;
};

/// What is written with a move.
struct NcMoveText {
  std::string_view number, words, comments;  ///< on the line of its first piece
  std::string_view path;                     ///< block of the path mode; empty: an exact path is in force
  std::uint32_t axes = 0;                    ///< bits of the axes that may be named
};

/// Writes pieces of moves, and knows what the control has in force after them: it says what changes, no more.
class NcPieceWriter {
 public:
  NcPieceWriter(const std::string& file, const NcProgramOptions& options,
                const std::function<void(std::string_view)>& write);

  /// Lines as they are, with their ends.
  void text(std::string_view lines);
  void apply(const NcControlEvents& events);
  /// From now on positions are said like this.
  void use_frame(const NcProgramFrame& frame);
  /// @throws InputError for what no program can say
  void move(const ProgramMove& move, const NcMoveText& with, std::span<const CorrectedPiece> pieces);
  /// Hands out what is in the buffer.
  void flush();

  /// Where the control stands, mm or degrees. @returns whether it is known
  bool position(std::size_t axis, double& value) const;
  std::size_t pieces() const { return piece_count_; }

 private:
  void write_piece(const ProgramMove& move, const NcMoveText& with, const CorrectedPiece& piece, bool first);
  /// Feed of a piece as the control takes it; `mode` may become inverse time.
  double feed_word(const ProgramMove& move, const CorrectedPiece& piece, std::uint32_t moved, FeedMode& mode) const;
  /// The mode in which the control takes the time that F in inverse time says, and its F.
  FeedMode slow_feed(const ProgramMove& move, const std::array<std::int64_t, kAxisWords>& words, std::uint32_t changed,
                     double& feed) const;
  /// F of a rotary move in which the piece moves linear axes too, so that the angle still has it.
  double feed_of_angle(const std::array<std::int64_t, kAxisWords>& words, std::uint32_t changed, double feed) const;
  /// Program units or degrees: the way that F is of, from where the words before stand.
  double feed_length(const std::array<std::int64_t, kAxisWords>& words, std::uint32_t changed) const;
  /// Says modes that are not in force.
  char* write_modes(const ProgramMove& move, FeedMode mode, char* at);
  char* write_pitch(const ProgramMove& move, double pitch, char* at) const;
  char* write_feed(const ProgramMove& move, FeedMode mode, double feed, char* at);
  /// Exact path for a piece, or the path mode of its move again.
  void write_path(std::string_view path, bool exact);
  double program_scale(std::size_t axis) const;
  /// Whether a control takes the word for where the axis stands already: a linear axis would have F for its own.
  bool is_no_motion(std::size_t axis, std::int64_t word) const;
  /// A value in units of the last decimal of its word.
  double word_units(std::size_t axis, double value) const;
  int decimals(std::size_t axis) const;
  void reserve(std::size_t bytes);
  [[noreturn]] void fail(const ProgramMove& move, const std::string& problem) const;

  const std::string& file_;
  const NcProgramOptions& options_;
  const std::function<void(std::string_view)>& write_;

  std::vector<char> out_;
  char* at_ = nullptr;
  NcProgramFrame frame_;
  std::array<std::int64_t, kAxisWords> said_{};  ///< words in units of their last decimal
  std::array<double, kAxisWords> scale_{};       ///< units of the last decimal per mm or degree
  std::array<int, kAxisWords> decimals_{};
  std::uint32_t is_said_ = 0;
  WordValues stands_{};  ///< end of the piece before, without rounding
  bool units_said_ = false, absolute_said_ = false, mode_said_ = false;
  bool exact_ = false;  ///< G61 stands before a piece, and has to be taken back
  FeedMode mode_ = FeedMode::per_minute;
  double feed_ = -1;
  bool feed_in_inches_ = false;  ///< unit in force when it was said
  std::size_t piece_count_ = 0;
};

}  // namespace abbe
