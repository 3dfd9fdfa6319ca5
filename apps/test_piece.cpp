#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/input_error.h"
#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "test_piece/sizes.h"

namespace abbe {
namespace {

struct TestPieceOptions {
  TestPieceSizes sizes;
  std::string output;
  double feed_mm_per_min = 1200, chord_um = 1;
};

/// @param text_of  cone_frustum_csv() or s_shape_csv()
template <typename Piece>
int write_piece(const TestPieceOptions& options, Piece sizes,
                std::string (*text_of)(const TestPieceSizes& sizes, const TestPiece& piece)) {
  sizes.feed = options.feed_mm_per_min / 60;
  sizes.chord_tolerance = options.chord_um / 1000;
  const TestPiece piece = test_piece_of(sizes);
  const std::string text = text_of(options.sizes, piece);
  if (options.output.empty()) {
    print_file(text);
    return kDone;
  }
  write_file_atomically(options.output, text);
  fmt::print("{}: {} points written; axis commands and program: abbe path {} --machine MACHINE -o program.ngc\n",
             options.output, piece.curve.points.size(), options.output);
  return kDone;
}

void add_common(Subcommand& piece, TestPieceOptions& options) {
  piece.add_output_file("-o,--output", options.output,
                        "CSV to write: points and directions of the tool (default: standard output)");
  piece.add_option("--feed-mm-per-min", options.feed_mm_per_min, "Feed of the centre of the tool tip")
      ->check(in_range(0.001, 1e6))
      ->capture_default_str();
  piece
      .add_option("--chord-um", options.chord_um,
                  "Largest distance of the tool's path from the lines between its points")
      ->check(in_range(0.001, 1000.0))
      ->capture_default_str();
}

}  // namespace

void add_test_piece_command(CommandLine& line) {
  Subcommand* command =
      line.add("test-piece", "Write tool paths of five-axis test pieces, milled with the flank of the tool",
               "  abbe test-piece cone-frustum -o cone.csv\n"
               "  abbe test-piece s-shape --centre-mm 0 0 30 -o s.csv\n\n"
               "Axis commands and a program: abbe path cone.csv --machine MACHINE -o cone.ngc. "
               "docs/test-pieces.md explains the sizes and\n"
               "what is measured on the pieces.");
  command->require_subcommand(1);
  auto options = std::make_shared<TestPieceOptions>();
  Subcommand* cone = command->add_subcommand("cone-frustum", "Inclined cone frustum (similar to ISO 10791-7, M3)");
  add_common(*cone, *options);
  add_cone_frustum_sizes(*cone, options->sizes);
  cone->callback([&line, options] {
    line.run = [options] { return write_piece(*options, cone_frustum_of(options->sizes), &cone_frustum_csv); };
  });
  Subcommand* s = command->add_subcommand("s-shape", "Wall in the shape of an S (similar to ISO 10791-7, M4)");
  add_common(*s, *options);
  add_s_shape_sizes(*s, options->sizes);
  s->callback([&line, options] {
    line.run = [options] { return write_piece(*options, s_shape_of(options->sizes), &s_shape_csv); };
  });
}

}  // namespace abbe
