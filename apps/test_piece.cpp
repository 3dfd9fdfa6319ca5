#include "abbe/machine/test_piece.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "abbe/formats/curve_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/results_folder.h"
#include "command.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// As people give them; what both pieces have.
struct TestPieceOptions {
  std::string output;
  std::vector<double> centre_mm;
  double tool_diameter_mm = 20, feed_mm_per_min = 1200, chord_um = 1;
  double base_diameter_mm = 80, half_apex_deg = 15, inclination_deg = 10, azimuth_deg = 0, height_mm = 0;
  double length_mm = 160, amplitude_mm = 40, lean_deg = 5, twist_deg = 15;
  bool force = false;
};

int write_piece(const TestPieceOptions& options, const char* what, const std::string& from,
                TestPiece (*make)(const TestPieceOptions&)) {
  if (options.centre_mm.size() != 3 && !options.centre_mm.empty()) {
    throw InputError({.field = "--centre-mm"}, "not three numbers", "x y z in the workpiece frame, mm");
  }
  TestPiece piece;
  try {
    piece = make(options);
  } catch (const std::invalid_argument& error) {
    throw InputError({.field = what}, "these sizes make no test piece", error.what());
  }
  std::string text = fmt::format("# {}: {}\n# tool of {} mm diameter\n", what, from, options.tool_diameter_mm);
  text += curve_csv(piece.curve);
  if (options.output.empty()) {
    fmt::print("{}", text);
    return kDone;
  }
  if (!options.force && std::filesystem::exists(options.output)) {
    throw InputError({.file = options.output}, "the file exists", "another name, or --force to replace it");
  }
  write_file_atomically(options.output, text);
  fmt::print("{}: {} points written; axis commands and program: abbe path MACHINE {} -o program.ngc\n", options.output,
             piece.curve.points.size(), options.output);
  return kDone;
}

/// What both pieces have.
template <typename Piece>
void take_common(const TestPieceOptions& options, Piece& piece) {
  if (options.height_mm > 0) piece.height = options.height_mm;
  piece.tool_radius = options.tool_diameter_mm / 2;
  piece.feed = options.feed_mm_per_min / 60;
  piece.chord_tolerance = options.chord_um / 1000;
}

TestPiece make_cone_frustum(const TestPieceOptions& options) {
  ConeFrustum frustum;
  take_common(options, frustum);
  frustum.base_diameter = options.base_diameter_mm;
  frustum.half_apex_angle = options.half_apex_deg * kDegree;
  frustum.inclination = options.inclination_deg * kDegree;
  frustum.lean_azimuth = options.azimuth_deg * kDegree;
  if (!options.centre_mm.empty()) frustum.base_centre = Eigen::Vector3d::Map(options.centre_mm.data());
  return cone_frustum(frustum);
}

TestPiece make_s_shape(const TestPieceOptions& options) {
  SShape shape;
  take_common(options, shape);
  shape.length = options.length_mm;
  shape.amplitude = options.amplitude_mm;
  shape.lean = options.lean_deg * kDegree;
  shape.twist = options.twist_deg * kDegree;
  shape.azimuth = options.azimuth_deg * kDegree;
  if (!options.centre_mm.empty()) shape.centre = Eigen::Vector3d::Map(options.centre_mm.data());
  return s_shape(shape);
}

void add_common(CLI::App& piece, TestPieceOptions& options, const char* centre, const char* height) {
  piece.add_option("-o,--output", options.output,
                   "CSV to write: points and directions of the tool (default: standard output)");
  piece.add_option("--centre-mm", options.centre_mm, centre)->expected(3);
  piece.add_option("--height-mm", options.height_mm, height)->check(CLI::PositiveNumber);
  piece.add_option("--tool-diameter-mm", options.tool_diameter_mm, "Diameter of the cylindrical cutter")
      ->capture_default_str();
  piece.add_option("--feed-mm-per-min", options.feed_mm_per_min, "Feed of the middle of the tool's end")
      ->capture_default_str();
  piece
      .add_option("--chord-um", options.chord_um,
                  "Largest distance of the tool's path from the lines between its points")
      ->capture_default_str();
  piece.add_option("--azimuth-deg", options.azimuth_deg, "Turn of the piece about Z")->capture_default_str();
  piece.add_flag("--force", options.force, "Replace an existing file");
}

}  // namespace

void add_test_piece_command(CommandLine& line) {
  CLI::App* command = line.add(
      "test-piece", "Tool paths of five-axis test pieces, milled with the flank of the tool",
      "  abbe test-piece cone-frustum -o cone.csv\n"
      "  abbe test-piece s-shape --centre-mm 0 0 30 -o s.csv\n\n"
      "Axis commands and a program: abbe path MACHINE cone.csv -o cone.ngc. Sizes and what is measured on the pieces:\n"
      "docs/test-pieces.md.");
  command->require_subcommand(1);
  auto options = std::make_shared<TestPieceOptions>();
  CLI::App* cone = command->add_subcommand("cone-frustum", "Inclined cone frustum (in the manner of ISO 10791-7, M3)");
  add_common(*cone, *options, "Centre of the base, workpiece frame (default 0 60 40)", "Along the axis (default 20)");
  cone->add_option("--base-diameter-mm", options->base_diameter_mm, "Diameter of the base")->capture_default_str();
  cone->add_option("--half-apex-deg", options->half_apex_deg, "Half of the angle at the apex")->capture_default_str();
  cone->add_option("--inclination-deg", options->inclination_deg, "Of the cone's axis from +Z")->capture_default_str();
  cone->callback([&line, options] {
    line.run = [options] {
      return write_piece(*options, "cone frustum",
                         fmt::format("base {} mm, half apex angle {} deg, inclination {} deg",
                                     options->base_diameter_mm, options->half_apex_deg, options->inclination_deg),
                         make_cone_frustum);
    };
  });
  CLI::App* s = command->add_subcommand("s-shape", "Wall in the shape of an S (in the manner of ISO 10791-7, M4)");
  add_common(*s, *options, "Middle of the foot, workpiece frame (default 0 0 30)", "Along Z (default 40)");
  s->add_option("--length-mm", options->length_mm, "From end to end along X")->capture_default_str();
  s->add_option("--amplitude-mm", options->amplitude_mm, "Of the sine that is the foot")->capture_default_str();
  s->add_option("--lean-deg", options->lean_deg, "Lean of the wall at its ends")->capture_default_str();
  s->add_option("--twist-deg", options->twist_deg, "Lean of the wall at the crests, to either side")
      ->capture_default_str();
  s->callback([&line, options] {
    line.run = [options] {
      return write_piece(*options, "S shape",
                         fmt::format("length {} mm, amplitude {} mm, lean {} deg, twist {} deg", options->length_mm,
                                     options->amplitude_mm, options->lean_deg, options->twist_deg),
                         make_s_shape);
    };
  });
}

}  // namespace abbe
