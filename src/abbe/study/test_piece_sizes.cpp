#include "abbe/study/test_piece_sizes.h"

#include <stdexcept>
#include <string>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

template <typename Sizes>
TestPiece made_of(const Sizes& sizes, TestPiece (*make)(const Sizes&), const char* what) {
  try {
    return make(sizes);
  } catch (const std::invalid_argument& error) {
    // What is wanted, behind the name of the piece.
    const std::string wanted = error.what();
    const std::size_t colon = wanted.find(": ");
    throw InputError({.field = what}, "these sizes make no test piece",
                     colon == std::string::npos ? wanted : wanted.substr(colon + 2));
  }
}

}  // namespace

TestPiece test_piece_of(const ConeFrustum& frustum) { return made_of(frustum, cone_frustum, "cone frustum"); }
TestPiece test_piece_of(const SShape& shape) { return made_of(shape, s_shape, "S shape"); }

}  // namespace abbe
