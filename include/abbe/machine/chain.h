#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "abbe/machine/machine.h"

namespace abbe {

/// What is wrong with a chain, and where.
struct ChainError {
  std::size_t position = 0;  ///< byte in the text, from 0; the length of the text if something is missing at its end
  std::size_t length = 1;    ///< bytes concerned, at least 1
  std::string found;         ///< what stands there: "'c'", "the end"
  std::string expected;      ///< what should stand there: "an axis letter, b or t"

  /// One line: "column 3: found 'c', expected ...".
  std::string message() const;
  /// The text with a line of carets under the place, for a terminal.
  std::string pointed(std::string_view text) const;
};

/// Result of parse_chain: a machine, or the first error.
struct ParsedChain {
  bool ok = false;
  Machine machine;   ///< valid if ok
  ChainError error;  ///< valid if not ok
};

/// Reads a chain from the workpiece to the tool, such as "w C' X' b Z t" or "wC'X'bZt", into a machine with defaults.
///
/// `w` workpiece, `b` bed, `t` tool, each once and in this order. An axis is a capital letter of ISO 841 (linear X Y Z
/// U V W P Q R, rotary A B C D E), a number where a letter occurs twice (C1, C2; at most 99), and a prime (' or U+2032)
/// where it carries the workpiece and its positive command moves the table the other way. An unprimed axis between w
/// and b carries the workpiece in its own positive sense. Blanks may stand between the items, not inside one.
///
/// Defaults, all to be replaced by the data of a real machine: direction from the letter; axis points at the origin;
/// travel
/// +-250 mm for linear axes, +-120 degrees for rotary ones, endless for those about Z; tool at the origin along +Z.
ParsedChain parse_chain(std::string_view text);

}  // namespace abbe
