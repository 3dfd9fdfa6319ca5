#include "abbe/formats/text/input_error.h"

#include <fmt/format.h>

#include <utility>

#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

/// Of a binary file a line can be everything, and any byte.
constexpr std::size_t kLongestField = 120, kLongestProblem = 2000;

std::string message(const InputError::Place& place, const std::string& problem, const std::string& expected) {
  // A name is on one line whatever is in it.
  std::string text = printable(place.file, kLongestProblem, LineFeeds::escaped);
  if (place.line > 0) text += fmt::format(":{}", place.line);
  if (place.line > 0 && place.column > 0) text += fmt::format(":{}", place.column);
  if (!text.empty()) text += ": ";
  if (!place.field.empty()) text += printable(place.field, kLongestField, LineFeeds::escaped) + ": ";
  text += printable(problem, kLongestProblem);
  if (!expected.empty()) text += "; expected " + expected;
  return text;
}

}  // namespace

InputError::InputError(Place place, std::string problem, std::string expected)
    : std::runtime_error(message(place, problem, expected)),
      place_(std::move(place)),
      problem_(std::move(problem)),
      expected_(std::move(expected)) {}

}  // namespace abbe
