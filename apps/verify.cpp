#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/axis_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/verification/verification.h"
#include "abbe/study/verification/verification_page.h"
#include "abbe/study/verification/verification_text.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "options.h"
#include "progress.h"
#include "test_piece/sizes.h"
#include "uncovered_poses.h"
#include "verify_readings.h"

namespace abbe {
namespace {

/// A test piece that was run twice.
struct PieceOptions {
  TestPieceSizes sizes;
  std::string before, after;
};

struct VerifyOptions {
  VerificationFiles files;
  std::string output, readings;
  std::vector<std::string> ranges;
  std::size_t poses = 1000;
  std::optional<std::size_t> seed;
  double reach_mm = 1;
  std::optional<double> least_reduction, largest_ratio;
  std::optional<PieceOptions> cone, s;
  bool json = false, accept_uncovered = false;
};

template <typename Sizes>
PieceToVerify piece_to_verify(const Machine& machine, const PieceOptions& options, const Sizes& sizes) {
  return {sizes,
          {options.before, read_trace(options.before, machine)},
          {options.after, read_trace(options.after, machine)}};
}

VerificationRequest request_of(const VerifyOptions& options) {
  VerificationRequest request = read_verification(options.files);
  tell_distrusted(request.errors_file, request.identified);
  request.poses = options.poses;
  if (options.seed) request.seed = *options.seed;
  request.ranges.resize(request.machine.axes.size());
  for (const std::string& text : options.ranges) take_range_option(request.machine, text, request.ranges);
  request.least_reduction = options.least_reduction;
  request.largest_ratio = options.largest_ratio;
  request.reach_mm = options.reach_mm;
  if (options.cone) {
    request.pieces.push_back(piece_to_verify(request.machine, *options.cone, cone_frustum_of(options.cone->sizes)));
  }
  if (options.s) {
    request.pieces.push_back(piece_to_verify(request.machine, *options.s, s_shape_of(options.s->sizes)));
  }
  return request;
}

/// Options of random poses and test pieces, which readings have no use for.
constexpr std::array<const char*, 6> kNotWithReadings = {"--machine", "--truth", "--poses",
                                                         "--seed",    "--range", "--reach-mm"};

void refuse_beside_readings(const Subcommand& command, const VerifyOptions& options) {
  const auto refuse = [](const char* option) {
    throw InputError({.field = option}, "cannot be combined with --readings", "one of them");
  };
  for (const char* const option : kNotWithReadings) {
    if (command.count(option) > 0) refuse(option);
  }
  if (options.cone) refuse("cone-frustum");
  if (options.s) refuse("s-shape");
}

int run_verify(const VerifyOptions& options) {
  if (!options.output.empty()) {
    const std::string extension = std::filesystem::path(options.output).extension().string();
    if (extension != ".html" && extension != ".htm") {
      throw InputError({.file = options.output}, "unknown kind of page", "a name ending in .html");
    }
  }
  if (!options.readings.empty()) {
    return run_verify_readings({.files = options.files,
                                .study = options.readings,
                                .least_reduction = options.least_reduction,
                                .largest_ratio = options.largest_ratio,
                                .page = options.output,
                                .json = options.json,
                                .accept_uncovered = options.accept_uncovered});
  }
  const VerificationRequest request = request_of(options);
  StepProgress progress;
  const Verification result = verify_compensation(
      request, {.progress = [&progress](VerificationStep step, std::size_t done, std::size_t total) {
        progress.show(step_words(step), done, total);
      }});
  progress.end();
  if (!options.output.empty()) write_file_atomically(options.output, verification_page(result));
  if (options.json) {
    fmt::print("{}", json_text(verification_json(result)));
  } else {
    fmt::print("{}", verification_text(result));
    if (!options.output.empty()) fmt::print("\npage: {}\n", options.output);
  }
  const int left_out = tell_left_out(result.left_out(), options.accept_uncovered);
  return result.says_no() ? kNegative : left_out;
}

Subcommand* add_piece(Subcommand& command, const char* name, const char* description, const char* example,
                      PieceOptions& piece) {
  Subcommand* app = command.add_subcommand(name, description);
  app->fallthrough();
  app->add_input_file("--before", piece.before, "Trace of the program as it was (*.csv)")->required();
  app->add_input_file("--after", piece.after, "Trace with the compensation (*.csv)")->required();
  app->footer(std::string("Sizes as in abbe test-piece ") + name +
              ".\nExample:\n  abbe verify --machine examples/machines/trunnion-mill.machine.toml --errors "
              "examples/compensate/trunnion.errors.toml --truth examples/verify/truth.errors.toml " +
              name + " " + example);
  return app;
}

}  // namespace

void add_verify_command(CommandLine& line) {
  struct Pieces {
    VerifyOptions options;
    PieceOptions cone, s;
    double reduction = 0, ratio = 0;
  };
  auto asked = std::make_shared<Pieces>();
  VerifyOptions& options = asked->options;
  Subcommand* command = line.add(
      "verify",
      "Check what a compensation leaves: with new readings, or at poses and on test pieces of a simulated machine",
      "  abbe verify examples/aguado/results/aguado\n"
      "  abbe verify --machine examples/machines/trunnion-mill.machine.toml --errors "
      "examples/compensate/trunnion.errors.toml --truth examples/verify/truth.errors.toml -o page.html "
      "cone-frustum --before examples/verify/cone-before.csv --after examples/verify/cone-after.csv s-shape --before "
      "examples/verify/s-before.csv --after examples/verify/s-after.csv\n"
      "  abbe verify --errors examples/compensate/trunnion.errors.toml --readings "
      "examples/verify/second-tracker.study.toml\n\n"
      "With --readings, the readings of a study replace the simulated truth: its set-ups are fitted to them,\n"
      "and what is left is compared with the uncertainties. The study states the machine.\n"
      "Test pieces come last, each with the traces of both runs and its sizes as in abbe test-piece. A trace\n"
      "is a CSV of what the axes were commanded while the program ran, a row for each servo cycle or so: time_s,\n"
      "X_mm, Y_mm, Z_mm, A_deg, C_deg. Method and figures: docs/verify.md.");
  command->add_option("results", options.files.results,
                      "Results folder of abbe run, of a study with simulated readings");
  add_states(*command, options.files.states);
  add_machine(*command, options.files.machine, "Machine file (default: machine.toml of the results)");
  add_errors(*command, options.files.errors, "Identified errors (default: errors.toml of the results)");
  command->add_input_file("--truth", options.files.truth, "True errors (default: truth.errors.toml of the results)");
  command->add_input_file("--readings", options.readings,
                          "Study with measured readings that were not used in the identification (*.study.toml)");
  command->add_option("--poses", options.poses, "Number of random poses")
      ->check(in_range(10, 10000))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of the random poses (default: that of the results, else 1)");
  command
      ->add_option("--range", options.ranges,
                   "AXIS_unit=from:to or AXIS_unit=position; repeatable (default: where the errors are known)")
      ->allow_extra_args(false);
  Option* const reduction = command->add_option("--least-reduction", asked->reduction,
                                                "Exit code 1 unless the mean volumetric error (with --readings: the "
                                                "mean residual) becomes this many times smaller");
  Option* const ratio = command->add_option(
      "--largest-ratio", asked->ratio,
      "Exit code 1 if the volumetric error (root mean square) is more than this many times its predicted standard "
      "uncertainty; with --readings: if what is left is more than this many times what the uncertainties explain");
  command
      ->add_option("--reach-mm", options.reach_mm,
                   "Samples farther than this from the tool path of the test piece do not cut it")
      ->check(in_range(0.01, 10.0))
      ->capture_default_str();
  command->add_flag("--accept-uncovered", options.accept_uncovered, kAcceptUncoveredWords);
  command->add_output_file("-o,--output", options.output, "Page to write (*.html)");
  command->add_flag("--json", options.json, "Print JSON for programs");
  command->require_subcommand(0, 2);
  Subcommand* const cone =
      add_piece(*command, "cone-frustum", "Inclined cone frustum (similar to ISO 10791-7, M3)",
                "--before examples/verify/cone-before.csv --after examples/verify/cone-after.csv", asked->cone);
  add_cone_frustum_sizes(*cone, asked->cone.sizes);
  Subcommand* const s =
      add_piece(*command, "s-shape", "Wall in the shape of an S (similar to ISO 10791-7, M4)",
                "--before examples/verify/s-before.csv --after examples/verify/s-after.csv", asked->s);
  add_s_shape_sizes(*s, asked->s.sizes);
  command->callback([&line, command, asked, reduction, ratio, cone, s] {
    line.run = [command, asked, reduction, ratio, cone, s] {
      VerifyOptions all = asked->options;
      if (reduction->count() > 0) all.least_reduction = asked->reduction;
      if (ratio->count() > 0) all.largest_ratio = asked->ratio;
      if (cone->parsed()) all.cone = asked->cone;
      if (s->parsed()) all.s = asked->s;
      if (!all.readings.empty()) refuse_beside_readings(*command, all);
      return run_verify(all);
    };
  });
}

}  // namespace abbe
