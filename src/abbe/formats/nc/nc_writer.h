#pragma once

// Internal to formats: moves on their way to the corrector and to the corrected program.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
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

/// Thrown where the budget of the options is spent; caught by correct_nc_program().
struct NcGivenUp {
  ProgramBudget::Spent spent;
};
/// @param pieces  corrected and not yet written @throws NcGivenUp
void refuse_spent_budget(const NcProgramOptions& options, std::size_t pieces = 0);

/// Collects the moves of a program and what stands between them, has them corrected and writes both in their order.
class NcWriter {
 public:
  NcWriter(const std::string& file, const NcProgramOptions& options, MoveCorrector& corrector,
           const std::function<void(std::string_view)>& write);

  /// A line between the moves, without its end.
  void line(std::string_view text);
  /// What the last line() did to the control: it must be said again.
  void forget_feed() { events_.forget_feed = true; }
  void said_feed_mode(FeedMode mode);
  void said_units() { events_.said_units = true; }
  void said_absolute() { events_.said_absolute = true; }

  /// What goes on the line of the next move's first piece: its number, words and comments.
  void set_number(std::string_view text) { number_ = text; }
  std::string& words() { return words_; }
  std::string& comments() { return comments_; }
  bool has_words() const { return !number_.empty() || !words_.empty() || !comments_.empty(); }
  /// The number, words and comments as a line, if there are any.
  void words_as_line();

  /// The block that puts the control's path mode into force, such as "G64 P0.1"; empty: an exact path is in force.
  void set_path(std::string_view block);
  /// From now on positions are said like this.
  void set_frame(const NcProgramFrame& frame);
  /// Positions of X, Y, Z mean something else now: what was said of them is not where the control is.
  void forget_linear_axes();

  /// @param words        bits of the axes that may be named: those whose position is known
  /// @param is_corrected false: it is written as it is
  void move(const ProgramMove& move, std::uint32_t words, bool is_corrected);

  /// Corrects and writes what was collected.
  void flush();
  /// Where the control stands after what was written, mm or degrees; call flush() before. @returns whether it is known
  bool position(std::size_t axis, double& value) const;
  /// Writes everything. @param mode the program's own feed mode, which is set again
  void finish();

  std::size_t moves() const { return move_count_; }
  std::size_t pieces() const { return piece_count_; }
  std::size_t uncorrected() const { return uncorrected_; }
  std::size_t first_uncorrected_line() const { return first_uncorrected_line_; }

 private:
  /// Changes of what the control has in force, by lines between moves.
  struct Events {
    bool forget_feed = false, said_units = false, said_absolute = false, sets_mode = false, forget_linear = false;
    FeedMode mode = FeedMode::per_minute;
  };
  struct Item {
    std::uint32_t lines = 0, number = 0, words = 0, comments = 0;  ///< where each ends in `texts_`
    std::uint32_t axes = 0;
    std::uint32_t frame = 0, path = 0;
    Events events;
    bool is_corrected = true;
  };

  void write_item(std::size_t i, const CorrectedPiece* pieces, std::size_t count);
  void write_piece(const ProgramMove& move, const Item& item, const CorrectedPiece& piece, bool first);
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
  void write_path(const Item& item, bool exact);
  void apply(const Events& events);
  void use_frame(std::size_t index);
  double program_scale(std::size_t axis) const;
  /// A value in units of the last decimal of its word.
  /// Whether a control takes the word for where the axis stands already: a linear axis would have F for its own.
  bool is_no_motion(std::size_t axis, std::int64_t word) const;
  double word_units(std::size_t axis, double value) const;
  int decimals(std::size_t axis) const;
  void append(std::string_view text);
  void reserve(std::size_t bytes);
  [[noreturn]] void fail(const ProgramMove& move, const std::string& problem) const;

  const std::string& file_;
  const NcProgramOptions& options_;
  MoveCorrector& corrector_;
  const std::function<void(std::string_view)>& write_;

  // Collected.
  std::vector<ProgramMove> moves_;
  std::vector<Item> items_;
  std::vector<NcProgramFrame> frames_;
  std::vector<std::string> paths_;
  std::string texts_;  ///< of the items, and behind them the lines before the next one
  std::size_t batch_;  ///< moves that are corrected together
  std::string number_, words_, comments_;
  Events events_;
  CorrectedPieces corrected_;

  // Written: what the control has in force.
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
  std::size_t move_count_ = 0, piece_count_ = 0, uncorrected_ = 0, first_uncorrected_line_ = 0;
};

}  // namespace abbe
