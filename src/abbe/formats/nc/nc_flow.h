#pragma once

// Internal to formats: which line of an NC program comes next.
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/nc/nc_block.h"

namespace abbe {

/// The order in which the lines of a program run: subroutines, loops and branches of O words, M98 and M99.
///
/// As LinuxCNC reads them (G-code, "O Codes"), within one file. Nothing is remembered for lines without O words, so
/// that a long program takes no memory; O words are found once, when the first of them runs.
class NcFlow {
 public:
  struct Limits {
    std::size_t depth = 10;              ///< of calls within calls
    std::size_t idle_jumps = 1'000'000;  ///< loops and calls one after the other without a move
  };

  NcFlow(std::string_view text, const std::string& file, NcParameters& parameters, NcExpression& expression,
         const Limits& limits);

  /// @returns whether there is another line
  bool next_line(std::string_view& line, std::size_t& number);
  /// Byte in the text behind the lines that were given out; it falls when a loop begins again.
  std::size_t offset() const { return place_.offset; }

  /// Carries out a line with an O word. @throws InputError
  void run(NcBlock& block);
  /// M98 P L: the subprogram O<P> so many times. @throws InputError
  void call_subprogram(const NcBlock& block, const NcWord& word, double label, double repeats);
  /// M99. @throws InputError outside a subprogram
  void end_subprogram(const NcBlock& block, const NcWord& word);
  /// A move happens: the loop that it stands in goes on.
  /// @returns how many did since a line was reached for the first time
  std::size_t moves() {
    idle_jumps_ = 0;
    return ++repeated_moves_;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  struct Place {
    std::size_t offset = 0;  ///< of the line
    std::size_t line = 0;    ///< lines before it
  };
  /// A line with an O word.
  struct Entry {
    Place here, behind;
    NcFlowWord word = NcFlowWord::none;
    std::size_t next = kNone;   ///< the next line with this name
    std::size_t start = kNone;  ///< where its loop or branch begins; of a `while` that ends a loop the `do`
    bool taken = false;         ///< `while` that ends a `do`
  };
  struct Loop {
    std::size_t entry = 0;
    long long left = 0;
  };
  struct Call {
    Place back;
    std::size_t sub = kNone;     ///< the entry
    bool is_subprogram = false;  ///< by M98: numbered parameters are the caller's
    long long left = 0;          ///< further times
    std::vector<Loop> loops;
  };

  void find_o_words();
  std::size_t entry_of(const NcBlock& block);
  /// The next line of this name that is one of two, from `entry` on. @throws InputError if there is none
  std::size_t find(const NcBlock& block, std::size_t entry, NcFlowWord one, NcFlowWord other);
  void jump(const NcBlock& block, const Place& place);
  void call(NcBlock& block);
  void enter(const NcBlock& block, std::size_t sub, bool is_subprogram, long long times);
  void leave(const NcBlock& block);
  void return_value(NcBlock& block);
  void branch(NcBlock& block, std::size_t entry);
  void loop(NcBlock& block, std::size_t entry);
  void leave_loop(NcBlock& block, std::size_t entry);
  double argument(NcBlock& block);
  static void expect_end(NcBlock& block);
  std::vector<Loop>& loops() { return calls_.empty() ? loops_ : calls_.back().loops; }

  std::string_view text_;
  const std::string& file_;
  NcParameters& parameters_;
  NcExpression& expression_;
  Limits limits_;
  Place place_, last_;  ///< of the next line and of the one given out last
  bool found_ = false;
  std::vector<Entry> entries_;
  std::map<std::string, std::size_t> subs_;
  std::vector<Call> calls_;
  std::vector<Loop> loops_;
  std::size_t idle_jumps_ = 0, repeated_moves_ = 0;
  std::vector<std::size_t> furthest_;  ///< byte reached, by the depth of calls
};

}  // namespace abbe
