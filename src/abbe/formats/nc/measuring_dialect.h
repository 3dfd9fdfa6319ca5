#pragma once

// Internal to formats: how controls write what a measuring program needs.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/nc/measuring_program.h"

namespace abbe {

/// "X" or "C1=", and "12.5".
struct StatedWord {
  std::string word, value;
};

/// The words of one control. Functions add blocks to the text.
class MeasuringDialect {
 public:
  virtual ~MeasuringDialect() = default;

  virtual void begin(const MeasuringProgramOptions& options) = 0;
  virtual void comment(const std::string& words) = 0;
  /// A text for the operator and a stop until he goes on.
  virtual void stop(const std::string& words) = 0;
  virtual void move(const std::vector<StatedWord>& words, const MeasuringProgramOptions& options) = 0;
  /// @param seconds  zero: nothing is written
  virtual void dwell(double seconds) = 0;
  virtual void m_function(int number) { line("M" + std::to_string(number)); }
  virtual void output(int number, bool on) = 0;
  virtual void end(const MeasuringProgramOptions& options) = 0;
  std::string text() { return std::move(text_); }

 protected:
  virtual void line(const std::string& block) { text_ += block + "\n"; }

  std::string text_;
};

std::unique_ptr<MeasuringDialect> measuring_dialect(NcDialect dialect);

/// "F3000", mm/min with three decimals at most.
/// @param feed    mm/s, above zero
/// @param option  that sets it, for messages
/// @throws InputError for a feed that these decimals make zero
std::string feed_text(double feed, const char* option = "--feed-mm-per-min");

/// The word of an axis in a program of that control.
/// @throws InputError for an axis that has none
std::string measuring_word(const Axis& axis, const MeasuringProgramOptions& options);

/// Characters that every control shows, in place of others a question mark; no brackets, quotes and control characters.
std::string plain_words(const std::string& text);

}  // namespace abbe
