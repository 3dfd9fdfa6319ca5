#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/results_folder.h"
#include "command.h"
#include "exit_code.h"
#include "options.h"
#include "verify/verify_job.h"
#include "verify/verify_page.h"
#include "verify/verify_text.h"

namespace abbe {
namespace {

/// Without it, a condition that nothing meets, or everything.
void check_condition(const char* option, std::optional<double> value) {
  if (!value || (*value > 0 && std::isfinite(*value))) return;
  throw InputError({.field = option}, fmt::format("{} is not a condition", *value), "a number above zero");
}

int run_verify(const VerifyOptions& options) {
  check_condition("--least-reduction", options.least_reduction);
  check_condition("--largest-ratio", options.largest_ratio);
  if (!options.output.empty()) {
    const std::string extension = std::filesystem::path(options.output).extension().string();
    if (extension != ".html" && extension != ".htm") {
      throw InputError({.file = options.output}, "unknown kind of page", "a name ending in .html");
    }
  }
  const VerifyResult result = verify(options);
  if (!options.output.empty()) write_file_atomically(options.output, verify_page(options, result));
  if (options.json) {
    fmt::print("{}", json_text(verify_json(result)));
  } else {
    print_verify(result);
    if (!options.output.empty()) fmt::print("\npage: {}\n", options.output);
  }
  const bool met = std::all_of(result.verdicts.begin(), result.verdicts.end(),
                               [](const VerifyVerdict& verdict) { return verdict.met; });
  const int left_out = tell_left_out(result.left_out(), options.accept_uncovered);
  return met ? left_out : kNegative;
}

Subcommand* add_piece(Subcommand& command, const char* name, const char* description, const char* example,
                      VerifyPiece& piece) {
  Subcommand* app = command.add_subcommand(name, description);
  app->fallthrough();
  app->add_option("--before", piece.before, "Trace of the program as it was (*.csv)")->required();
  app->add_option("--after", piece.after, "Trace with the compensation (*.csv)")->required();
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
    VerifyPiece cone, s;
    double reduction = 0, ratio = 0;
  };
  auto asked = std::make_shared<Pieces>();
  VerifyOptions& options = asked->options;
  Subcommand* command = line.add(
      "verify", "Check what a compensation leaves: unseen poses and test pieces, against the simulated truth",
      "  abbe verify examples/aguado/results/aguado\n"
      "  abbe verify --machine examples/machines/trunnion-mill.machine.toml --errors "
      "examples/compensate/trunnion.errors.toml --truth examples/verify/truth.errors.toml -o page.html "
      "cone-frustum --before examples/verify/cone-before.csv --after examples/verify/cone-after.csv s-shape --before "
      "examples/verify/s-before.csv --after examples/verify/s-after.csv\n\n"
      "Test pieces come last, each with the traces of both runs and its sizes as in abbe test-piece. A trace "
      "is\n"
      "a CSV of what the axes were commanded while the program ran, a row for each servo cycle or so: time_s, X_mm,\n"
      "Y_mm, Z_mm, A_deg, C_deg. Method and figures: docs/verify.md.");
  command->add_option("results", options.results, "Results folder of abbe run for a study with simulated readings");
  command->add_option("--machine", options.machine, "Machine file (default: machine.toml of the results)");
  command->add_option("--errors", options.errors, "Identified errors (default: errors.toml of the results)");
  command->add_option("--truth", options.truth, "True errors (default: truth.errors.toml of the results)");
  command->add_option("--poses", options.poses, "Number of random poses")
      ->check(in_range(10, 10000))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of the random poses (default: that of the results, else 1)");
  command
      ->add_option("--range", options.ranges,
                   "AXIS_unit=from:to or AXIS_unit=position; repeatable (default: where the errors are known)")
      ->allow_extra_args(false);
  Option* const reduction =
      command->add_option("--least-reduction", asked->reduction,
                          "Exit code 1 unless the mean volumetric error becomes this many times smaller");
  Option* const ratio =
      command->add_option("--largest-ratio", asked->ratio,
                          "Exit code 1 if the volumetric error (root mean square) is more than this many times its "
                          "predicted standard uncertainty");
  command->add_option("--reach-mm", options.reach, "A sample farther from the test piece's tool path does not cut it")
      ->check(in_range(0.01, 10.0))
      ->capture_default_str();
  command->add_flag("--accept-uncovered", options.accept_uncovered, kAcceptUncoveredWords);
  command->add_output_file("-o,--output", options.output, "Page to write (*.html)");
  command->add_flag("--json", options.json, "Print JSON for programs");
  command->require_subcommand(0, 2);
  Subcommand* const cone =
      add_piece(*command, "cone-frustum", "Inclined cone frustum (in the manner of ISO 10791-7, M3)",
                "--before examples/verify/cone-before.csv --after examples/verify/cone-after.csv", asked->cone);
  add_cone_frustum_sizes(*cone, asked->cone.sizes);
  Subcommand* const s =
      add_piece(*command, "s-shape", "Wall in the shape of an S (in the manner of ISO 10791-7, M4)",
                "--before examples/verify/s-before.csv --after examples/verify/s-after.csv", asked->s);
  add_s_shape_sizes(*s, asked->s.sizes);
  asked->cone.is_cone = true;
  command->callback([&line, asked, reduction, ratio, cone, s] {
    line.run = [asked, reduction, ratio, cone, s] {
      VerifyOptions all = asked->options;
      if (reduction->count() > 0) all.least_reduction = asked->reduction;
      if (ratio->count() > 0) all.largest_ratio = asked->ratio;
      if (cone->parsed()) all.pieces.push_back(asked->cone);
      if (s->parsed()) all.pieces.push_back(asked->s);
      return run_verify(all);
    };
  });
}

}  // namespace abbe
