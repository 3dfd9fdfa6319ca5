#pragma once

// Internal to formats: moves on their way to the corrector and to the corrected program.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/program/program_move.h"
#include "abbe/formats/nc/nc_piece_writer.h"
#include "abbe/formats/nc/nc_program.h"

namespace abbe {

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
  bool position(std::size_t axis, double& value) const { return out_.position(axis, value); }
  /// Writes everything.
  void finish();

  std::size_t moves() const { return move_count_; }
  std::size_t pieces() const { return out_.pieces(); }
  std::size_t uncorrected() const { return uncorrected_; }
  std::size_t first_uncorrected_line() const { return first_uncorrected_line_; }

 private:
  struct Item {
    std::uint32_t lines = 0, number = 0, words = 0, comments = 0;  ///< where each ends in `texts_`
    std::uint32_t axes = 0;
    std::uint32_t frame = 0, path = 0;
    NcControlEvents events;
    bool is_corrected = true;
  };

  void write_item(std::size_t i, std::span<const CorrectedPiece> pieces);

  const std::string& file_;
  const NcProgramOptions& options_;
  MoveCorrector& corrector_;
  NcPieceWriter out_;

  std::vector<ProgramMove> moves_;
  std::vector<Item> items_;
  std::vector<NcProgramFrame> frames_;
  std::vector<std::string> paths_;
  std::string texts_;  ///< of the items, and behind them the lines before the next one
  std::size_t batch_;  ///< moves that are corrected together
  std::string number_, words_, comments_;
  NcControlEvents events_;
  CorrectedPieces corrected_;
  std::size_t move_count_ = 0, uncorrected_ = 0, first_uncorrected_line_ = 0;
};

}  // namespace abbe
