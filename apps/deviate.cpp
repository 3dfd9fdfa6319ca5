#include <optional>
#include <utility>

#include "abbe/study/scans/streamed_deviations.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "scan/scan_files.h"

namespace abbe {
namespace {

struct DeviateCommand {
  ScanFiles files;
  EvaluationOptions options;
  ScanDeviationsRequest request;
  StreamingOptions streaming;
  double lower_mm = 0, upper_mm = 0;
  bool faces_of_file = false;
};

int run_deviate(const DeviateCommand& command, ProcessGroup* processes) {
  ScanDeviationsRequest request = command.request;
  if (!request.transform_file.empty()) request.pose = read_transform_file(request.transform_file);
  if (command.lower_mm != 0 || command.upper_mm != 0) request.tolerance = {command.lower_mm, command.upper_mm};
  request.scan_file = command.files.scan;
  request.part_file = command.files.part;
  request.part = command.files.read_part();
  request.faces = command.faces_of_file ? DeviationFaces::of_file
                  : request.crease > 0  ? DeviationFaces::by_edges
                                        : DeviationFaces::none;
  request.threads = command.files.threads;
  request.tolerances = command.options.tolerances;
  request.page = !command.options.output.empty();
  SharedWork work(processes, command.options.output, tell_sentence);
  std::optional<TextOnDisk> csv;  // long: it is written while points are compared
  if (work.is_first() && request.page) request.take_csv = csv.emplace(command.options.output).taker();
  ScanDeviations result = deviations_of_file(std::move(request), command.files.scan_options(), command.streaming,
                                             work.job(Progress("comparing").callback()));
  if (!work.is_first()) return kDone;
  const int code = finish_evaluation(result.report, command.options, {}, [&](ResultsFolder& results) {
    write_deviation_files(result, std::move(csv), results);
  });
  work.done();
  return result.has_points() && !result.elsewhere ? code : static_cast<int>(kNegative);
}

}  // namespace

void add_deviate_command(CommandLine& line) {
  auto command = std::make_shared<DeviateCommand>();
  Subcommand* app = line.add(
      "deviate", "Compute the signed deviation of a scan from its part: statistics, coloured points, report",
      "  abbe deviate examples/scan/pin-scan.csv examples/scan/pin.stl --transform examples/scan/pin-transform.csv\n"
      "  abbe deviate examples/scan/bracket-scan.csv examples/scan/bracket.stl --transform "
      "examples/scan/bracket-transform.csv --largest-mm 0.3 --faces-deg 30 --tolerance p95_um=60 -o "
      "results/deviation");
  add_scan_files(app, command->files);
  app->add_input_file(
      "--transform", command->request.transform_file,
      "Pose of the scan on the part: transform.csv of abbe register (default: the scan is in the frame of the part)");
  add_number(app, "--largest-mm", Quantity::length, "mm", {0, 1e9}, command->request.largest_mm,
             "Leave out points farther from the part than this (default 0: none)");
  add_number(app, "--lower-um", Quantity::length, "um", {-1e9, 1e9}, command->lower_mm,
             "With --upper-um: a band; reports the share of points within it");
  add_number(app, "--upper-um", Quantity::length, "um", {-1e9, 1e9}, command->upper_mm, "Upper end of the band");
  add_number(app, "--faces-deg", Quantity::angle, "deg", {0, 180}, command->request.crease,
             "Add statistics by face, where faces end at edges sharper than this angle (default 0: none)");
  app->add_flag("--faces", command->faces_of_file,
                "Add statistics by the faces of a STEP file, or by the objects, groups and materials of an OBJ file")
      ->excludes("--faces-deg");
  add_number(app, "--colour-um", Quantity::length, "um", {0, 1e9}, command->request.colour_mm,
             "Deviation shown in full colour (default: from the 98th percentile)");
  app->add_output_folder("-o,--output", command->options.output,
                         "Results folder to write: evaluation.json, deviation.csv, deviation.ply (coloured), plot.svg, "
                         "report.html (part in three dimensions, sections)");
  app->add_option("--tolerance", command->options.tolerances,
                  "Largest permitted amount of a figure, such as maximum_um=50; repeatable. Exit code 1 if "
                  "exceeded")
      ->allow_extra_args(false);
  app->add_option(
      "--stream-above", command->streaming.above,
      "Number of points above which a scan is read in blocks (docs/scale.md); 27 bytes of a text file count as one");
  app->add_flag("--json", command->options.json, "Print JSON for programs");
  app->callback([&line, command] { line.share([command](ProcessGroup* all) { return run_deviate(*command, all); }); });
}

}  // namespace abbe
