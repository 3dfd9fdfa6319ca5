#include "abbe/formats/text/list_text.h"

#include <fmt/format.h>

#include <algorithm>

namespace abbe {

std::string counted(std::size_t count, const char* one, const char* more) {
  return fmt::format("{} {}", count, count == 1 ? one : more);
}

std::string first_few(const std::vector<std::string>& texts, std::string_view between) {
  constexpr std::size_t kShown = 5;
  const auto shown = static_cast<std::ptrdiff_t>(std::min(texts.size(), kShown));
  std::string text = fmt::format("{}", fmt::join(texts.begin(), texts.begin() + shown, between));
  if (texts.size() > kShown) text += fmt::format("{}and {} more", between, texts.size() - kShown);
  return text;
}

}  // namespace abbe
