#include "abbe/formats/input_error.h"

#include <fmt/format.h>

#include <utility>

namespace abbe {
namespace {

std::string message(const InputError::Place& place, const std::string& problem, const std::string& expected) {
  std::string text = place.file;
  if (place.line > 0) text += fmt::format(":{}", place.line);
  if (place.line > 0 && place.column > 0) text += fmt::format(":{}", place.column);
  if (!text.empty()) text += ": ";
  if (!place.field.empty()) text += place.field + ": ";
  text += problem;
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
