#include "abbe/formats/nc/measuring_dialect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"

namespace abbe {
namespace {

/// "2", "0.25".
std::string seconds_text(double seconds) { return trimmed_decimals(seconds, 3); }

std::string joined(const std::vector<StatedWord>& words, const char* sign = "") {
  std::string text;
  for (const StatedWord& word : words) {
    text += " " + word.word + (word.value[0] == '-' ? "" : sign) + word.value;
  }
  return text;
}

/// A move of the controls that know G0 and G1.
/// @param past_offsets  word before a move in machine coordinates
/// @param at_feed       words of a move at a feed
std::string g_code_move(const std::vector<StatedWord>& words, const MeasuringProgramOptions& options,
                        const char* past_offsets, const char* at_feed = "G1") {
  std::string block = options.machine_coordinates ? past_offsets + std::string(" ") : "";
  block += (options.feed > 0 ? at_feed : "G0") + joined(words);
  return options.feed > 0 ? block + " " + feed_text(options.feed) : block;
}

/// RS274/NGC: T. Kramer, F. Proctor, E. Messina, The NIST RS274NGC Interpreter, NISTIR 6556 (2000); ISO 6983-1.
class IsoDialect : public MeasuringDialect {
 public:
  void begin(const MeasuringProgramOptions& /*options*/) override { line("G21 G90 G94 G40 G49 G80"); }
  void comment(const std::string& words) override { line("(" + plain_words(words) + ")"); }
  void stop(const std::string& words) override {
    comment(words);
    line("M0");
  }
  void move(const std::vector<StatedWord>& words, const MeasuringProgramOptions& options) override {
    line(g_code_move(words, options, "G53"));
  }
  void dwell(double seconds) override {
    if (seconds > 0) line("G4 P" + seconds_text(seconds));
  }
  void output(int /*number*/, bool /*on*/) override {}
  void end(const MeasuringProgramOptions& /*options*/) override { line("M30"); }
};

/// LinuxCNC, G-Code and M-Code Reference.
class LinuxCncDialect : public IsoDialect {
 public:
  /// G61: the machine stands at every pose, whatever the path mode was.
  void begin(const MeasuringProgramOptions& /*options*/) override { line("G21 G90 G94 G40 G49 G80 G61"); }
  void stop(const std::string& words) override {
    line("(MSG, " + plain_words(words) + ")");
    line("M0");
  }
  void output(int number, bool on) override { line(fmt::format("{} P{}", on ? "M64" : "M65", number)); }
};

/// HEIDENHAIN, Klartext: TNC 640, User's Manuals (Klartext programming; cycles: Cycle 9).
class HeidenhainDialect : public MeasuringDialect {
 public:
  void begin(const MeasuringProgramOptions& options) override { line("BEGIN PGM " + options.name + " MM"); }
  void comment(const std::string& words) override { line("; " + plain_words(words)); }
  void stop(const std::string& words) override {
    comment(words);
    line("STOP");
  }
  void move(const std::vector<StatedWord>& words, const MeasuringProgramOptions& options) override {
    line("L" + joined(words, "+") + " R0 " + (options.feed > 0 ? feed_text(options.feed) : "FMAX") +
         (options.machine_coordinates ? " M91" : ""));
  }
  void dwell(double seconds) override {
    if (!(seconds > 0)) return;
    line("CYCL DEF 9.0 DWELL TIME");
    line("CYCL DEF 9.1 DWELL " + seconds_text(seconds));
  }
  void output(int /*number*/, bool /*on*/) override {}
  void end(const MeasuringProgramOptions& options) override {
    line("M30");
    line("END PGM " + options.name + " MM");
  }

 protected:
  void line(const std::string& block) override { text_ += fmt::format("{} {}\n", number_++, block); }

 private:
  std::size_t number_ = 0;
};

/// SINUMERIK 840D sl, Programming Manuals "Fundamentals" (G4, MSG, SUPA, M0, RTLION) and "Job planning" (STOPRE,
/// $A_OUT).
class SiemensDialect : public MeasuringDialect {
 public:
  /// G60: exact stop; RTLION: G0 is a straight line in the axes.
  void begin(const MeasuringProgramOptions& /*options*/) override { line("G710 G90 G94 G40 G60 RTLION"); }
  void comment(const std::string& words) override { line("; " + plain_words(words)); }
  void stop(const std::string& words) override {
    line("MSG(\"" + plain_words(words) + "\")");
    line("M0");
    line("MSG()");
  }
  void move(const std::vector<StatedWord>& words, const MeasuringProgramOptions& options) override {
    line(g_code_move(words, options, "SUPA"));
  }
  void dwell(double seconds) override {
    if (seconds > 0) line("G4 F" + seconds_text(seconds));
  }
  /// The control works ahead: without STOPRE the output would be switched too early.
  void output(int number, bool on) override {
    line("STOPRE");
    line(fmt::format("$A_OUT[{}]={}", number, on ? 1 : 0));
  }
  void end(const MeasuringProgramOptions& /*options*/) override { line("M30"); }
};

/// FANUC Series 30i, Operator's Manual (G04, G53; custom macros: interface signals, buffering).
class FanucDialect : public MeasuringDialect {
 public:
  void begin(const MeasuringProgramOptions& options) override {
    line("%");
    line("O0001 (" + capitals(options.name) + ")");
    line("G21 G90 G94 G40 G49 G80");
  }
  void comment(const std::string& words) override { line("(" + capitals(plain_words(words)) + ")"); }
  void stop(const std::string& words) override {
    comment(words);
    line("M0");
  }
  void move(const std::vector<StatedWord>& words, const MeasuringProgramOptions& options) override {
    line(g_code_move(words, options, "G53", "G1 G9"));
  }
  /// P counts milliseconds and takes no decimal point.
  void dwell(double seconds) override {
    if (seconds > 0) line(fmt::format("G4 P{:.0f}", 1e3 * seconds));
  }
  /// A macro statement is executed when it is read ahead; a block with G53 ends reading ahead.
  void output(int number, bool on) override {
    line("G53");
    line(fmt::format("#{}={}", number, on ? 1 : 0));
  }
  void end(const MeasuringProgramOptions& /*options*/) override {
    line("M30");
    line("%");
  }

 private:
  static std::string capitals(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), upper_case);
    return text;
  }
};

}  // namespace

std::unique_ptr<MeasuringDialect> measuring_dialect(NcDialect dialect) {
  switch (dialect) {
    case NcDialect::linuxcnc:
      return std::make_unique<LinuxCncDialect>();
    case NcDialect::heidenhain:
      return std::make_unique<HeidenhainDialect>();
    case NcDialect::siemens:
      return std::make_unique<SiemensDialect>();
    case NcDialect::fanuc:
      return std::make_unique<FanucDialect>();
    default:
      return std::make_unique<IsoDialect>();
  }
}

std::string feed_text(double feed, const char* option) {
  std::string text = trimmed_decimals(60 * feed, 3);
  if (text == "0") {
    throw InputError({.field = option}, "is 0 with the three decimals of a program", "0.001 or more");
  }
  return "F" + text;
}

std::string measuring_word(const Axis& axis, const MeasuringProgramOptions& options) {
  PathProgramOptions words;
  words.words = options.words;
  std::string word = axis_word(axis.name, words);
  // Names with numbers ("C1=30") are words of Siemens alone.
  const bool has_names = options.dialect == NcDialect::siemens;
  const std::string_view letters = "XYZABCUVW";
  if (!has_names && (word.size() != 1 || letters.find(upper_case(word[0])) == std::string_view::npos)) {
    throw InputError({.field = "--word"},
                     fmt::format("axis {} has the word {}, which this control does not have", axis.name, word),
                     fmt::format("a letter of X Y Z A B C U V W, such as --word {}=C", axis.name));
  }
  return word;
}

std::string plain_words(const std::string& text) {
  std::string plain;
  for (const char c : text) {
    // Bytes that continue a character of UTF-8 have been told by its first one.
    if ((static_cast<unsigned char>(c) & 0xC0U) == 0x80U) continue;
    const bool has_a_meaning = std::string_view("()\"%;#[]").find(c) != std::string_view::npos;
    plain += has_a_meaning || static_cast<unsigned char>(c) < ' ' ? ' '
             : static_cast<unsigned char>(c) < 0x7F               ? c
                                                                  : '?';
  }
  return plain;
}

}  // namespace abbe
