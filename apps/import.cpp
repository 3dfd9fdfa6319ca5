#include <fmt/format.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/dh_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/readings/planned_touches.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/imports/imported_file.h"
#include "command.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"

namespace abbe {
namespace {

struct ImportCommand {
  std::string file, format, machine, mapping, output, written_mapping, touches;
  std::vector<std::string> words;
  std::string kind, encoding, separator, decimal, length_unit, angle_unit, azimuth, vertical, mirrored;
  bool accept_uncertain = false, json = false, dh = false;
};

/// The value of an option that has one of several words.
template <typename Value>
std::optional<Value> value_of(const std::string& word, const std::vector<std::string_view>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (word == words[i]) return static_cast<Value>(i);
  }
  return std::nullopt;
}

std::vector<std::string> texts(const std::vector<std::string_view>& words) { return {words.begin(), words.end()}; }

ImportRequest request_of(const ImportCommand& command) {
  ImportRequest request;
  request.file = command.file;
  request.format = command.format;
  request.kind = import_kind_named(command.kind);
  if (!command.machine.empty()) request.machine = read_machine(command.machine);
  std::optional<TextEncoding> encoding = encoding_named(command.encoding);
  if (!command.mapping.empty()) {
    request.mapping = read_import_mapping(command.mapping);
    if (!encoding) encoding = request.mapping->encoding;
  }
  request.text = read_foreign_text(command.file, {.encoding = encoding});
  ImportHints& hints = request.hints;
  hints.layout.separator = value_of<FieldSeparator>(command.separator, separator_names());
  hints.layout.decimal = value_of<DecimalMark>(command.decimal, decimal_names());
  hints.length_unit = command.length_unit;
  hints.angle_unit = command.angle_unit;
  if (!command.azimuth.empty()) hints.clockwise = command.azimuth == "clockwise";
  if (!command.vertical.empty()) hints.zenith = command.vertical == "zenith";
  hints.mirrored = command.mirrored;
  request.accept_doubts = command.accept_uncertain;
  return request;
}

/// A log of LinuxCNC and the touches that its program planned.
int run_touches(const ImportCommand& command) {
  if (command.machine.empty()) {
    throw InputError({.field = "--machine"}, "missing", "the machine whose touches they are (*.machine.toml)");
  }
  const Machine machine = read_machine(command.machine);
  const std::map<std::string, std::string> words = axis_words(machine, command.words, "--word");
  const std::vector<PlannedTouch> touches = read_planned_touches(command.touches, machine);
  const MappedFile log(command.file);
  const std::string readings = probed_touches_csv(machine, touches, command.touches, log.text(), command.file, words);
  if (!command.output.empty()) write_file_atomically(command.output, readings);
  if (command.json) {
    fmt::print("{}", json_text({{"format", "abbe-touches/1"}, {"file", command.file}, {"touches", touches.size()}}));
    return kDone;
  }
  fmt::print("{}: {} touches, each where {} has it\n", command.file, touches.size(), command.touches);
  if (!command.output.empty()) fmt::print("{} written\n", command.output);
  return kDone;
}

/// A Denavit-Hartenberg table as a machine file.
int run_dh(const ImportCommand& command) {
  write_file_atomically(command.output, dh_machine_text(read_dh_arm(command.file), command.file));
  fmt::print("{} written\n", command.output);
  return kDone;
}

int run_import(const ImportCommand& command) {
  if (command.dh) return run_dh(command);
  if (!command.touches.empty()) return run_touches(command);
  const ImportedTable result = import_table(request_of(command));
  // A mapping is written with what is in doubt, to be looked at; readings that may be wrong are not.
  if (!command.written_mapping.empty()) write_file_atomically(command.written_mapping, imported_mapping_text(result));
  const bool is_written = result.is_certain() && !command.output.empty();
  if (is_written) write_file_atomically(command.output, result.rows.csv);
  if (command.json) {
    fmt::print("{}", json_text(imported_table_json(result)));
  } else {
    fmt::print("{}", imported_table_text(result));
    if (!command.written_mapping.empty()) fmt::print("{} written\n", command.written_mapping);
    if (is_written) fmt::print("{} written\n", command.output);
  }
  if (result.is_certain()) return kDone;
  tell("abbe: {}: {}{}\n", command.file, command.output.empty() ? "" : command.output + " is not written; ",
       what_to_do_next(result));
  return kNegative;
}

}  // namespace

void add_import_command(CommandLine& line) {
  auto command = std::make_shared<ImportCommand>();
  Subcommand* app = line.add(
      "import", "Turn a table of another program, or a file of an instrument, into a file that abbe reads",
      "  abbe import examples/import/total-station.txt --machine examples/machines/three-axis-mill.machine.toml "
      "--azimuth clockwise -o readings.csv --write-mapping total-station.import.toml\n"
      "  abbe import examples/import/total-station.txt --machine examples/machines/three-axis-mill.machine.toml "
      "--mapping examples/import/total-station.import.toml -o readings-again.csv\n"
      "  abbe import examples/import/positioning.csv -o positioning.csv\n"
      "  abbe import examples/import/points-inch.txt --as points\n"
      "  abbe import examples/import/laser.rtl --length-unit mm -o laser.csv\n"
      "  abbe import examples/import/probe-log.txt --format linuxcnc-probe --length-unit mm -o probed.csv\n\n"
      "It finds encoding, separator, decimal mark, header and units, proposes where each column comes from, and says "
      "why. Files of instruments are recognised by their contents.\n"
      "Exit code 1: something is uncertain and the table is not written; the text says what. docs/import.md.");
  app->add_input_file("file", command->file, "Table or file of an instrument, as text, also compressed by gzip")
      ->required();
  app->add_option(
         "--as", command->kind,
         "Kind of the result: points, tracker, positioning, circular or temperatures (default: by its columns)")
      ->check(one_of(import_kind_names()));
  add_machine(*app, command->machine, "Machine whose commands are in the table of a tracker (*.machine.toml)");
  app->add_input_file("--mapping", command->mapping, "Mapping to use: nothing is proposed (*.import.toml)");
  app->add_option("--format", command->format,
                  "Format of the file (default: by its contents): a table, or a file of an instrument or a control")
      ->check(one_of(import_format_names()))
      ->excludes("--mapping");
  app->add_option("--encoding", command->encoding,
                  "Encoding (default: from the bytes): utf-8, utf-16le, utf-16be, windows-1252 (also for Latin-1)")
      ->check(one_of(encoding_names()));
  app->add_option("--separator", command->separator, "Between columns (default: found): comma, semicolon, tab, blanks")
      ->check(one_of(texts(separator_names())))
      ->excludes("--mapping");
  app->add_option("--decimal", command->decimal, "Decimal mark (default: found from all rows): point, comma")
      ->check(one_of(texts(decimal_names())))
      ->excludes("--mapping");
  app->add_option("--length-unit", command->length_unit, "Unit of lengths that state none: mm, um, m, inch, ...")
      ->check(one_of(import_unit_names(Quantity::length)))
      ->excludes("--mapping");
  app->add_option("--angle-unit", command->angle_unit, "Unit of angles that state none: deg, rad, gon, ...")
      ->check(one_of(import_unit_names(Quantity::angle)))
      ->excludes("--mapping");
  app->add_option("--azimuth", command->azimuth, "Sense of azimuths, seen from above")
      ->check(one_of({"clockwise", "anticlockwise"}))
      ->excludes("--mapping");
  app->add_option("--vertical", command->vertical, "Zero of vertical angles")
      ->check(one_of({"zenith", "horizontal"}))
      ->excludes("--mapping");
  app->add_option("--mirrored", command->mirrored, "Coordinate of a left-handed frame that is to be reversed")
      ->check(one_of({"x", "y", "z"}))
      ->excludes("--mapping");
  app->add_flag("--accept-uncertain", command->accept_uncertain, "Accept the proposal even where it is uncertain")
      ->excludes("--mapping");
  app->add_output_file("--write-mapping", command->written_mapping, "Mapping to write (*.import.toml)");
  app->add_output_file("-o,--output", command->output, "CSV to write (default: only report what was found)");
  app->add_flag("--json", command->json, "Print JSON for programs");
  Option* const touches = app->add_input_file(
      "--touches", command->touches,
      "The file is a log of LinuxCNC, and these are the touches of its program (abbe program --touches): they become "
      "readings of a touch probe");
  Option* const dh = app->add_flag(
      "--dh", command->dh, "The file is a Denavit-Hartenberg table (*.dh.toml, *.csv): it becomes a machine file");
  dh->needs("--output")->excludes("--touches")->excludes("--machine")->excludes("--json");
  // The form of a log and of its touches is known, and that of a table of joints.
  for (const char* other :
       {"--as", "--mapping", "--format", "--encoding", "--separator", "--decimal", "--length-unit", "--angle-unit",
        "--azimuth", "--vertical", "--mirrored", "--accept-uncertain", "--write-mapping"}) {
    touches->excludes(other);
    dh->excludes(other);
  }
  app->add_option("--word", command->words, "Word of an axis in that program, AXIS=WORD (C1=C); repeatable")
      ->needs("--touches");
  app->callback([&line, command] { line.run = [command] { return run_import(*command); }; });
}

}  // namespace abbe
