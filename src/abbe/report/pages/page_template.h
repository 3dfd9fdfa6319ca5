#pragma once

#include <span>
#include <string_view>

namespace abbe {

/// The page without data, in pieces to be joined; made from web/ when the library is built.
std::span<const std::string_view> page_template();

}  // namespace abbe
