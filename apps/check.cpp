#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/file_kind.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/words/machine_check_words.h"
#include "abbe/study/compensation/frozen_file.h"
#include "check_geometry.h"
#include "check_study_file.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "options.h"

namespace abbe {
namespace {

void refuse_if_given(const Option* option, const char* why) {
  if (option->count() > 0) throw InputError({.field = option->get_name()}, why, "no such option");
}

}  // namespace

void add_check_command(CommandLine& line) {
  struct Options {
    std::string file, machine, errors;
    bool json = false;
    GeometryCheckOptions geometry;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command = line.add(
      "check", "Validate a machine, a study with its readings, a frozen compensation, a mesh or a point cloud",
      "  abbe check --machine examples/machines/trunnion-mill.machine.toml\n"
      "  abbe check --machine examples/machines/aguado.machine.toml --errors "
      "examples/aguado/results/aguado/errors.toml\n"
      "  abbe check examples/aguado/aguado.study.toml\n"
      "  abbe check examples/parts/wedge.stl --unit mm\n"
      "The readings of a study are compared with the nominal machine; nothing is identified.\n"
      "A frozen compensation (abbe compensate freeze) is refused here as a controller would refuse it.\n"
      "Exit code 1: the nominal machine does not explain the readings of a study; the inside and outside of a mesh\n"
      "cannot be told apart everywhere (turned or branching edges, duplicate triangles, inside out); or faces were\n"
      "left out. Holes are counted; they are not an error.");
  command->add_input_file(
      "file", options->file,
      "Study (.study.toml), frozen compensation (.abbec), mesh (.stl .ply .obj .step .stp) or point cloud (.xyz .asc "
      ".pts .csv .ply .pcd .e57)");
  const Option* const machine_option = add_machine(*command, options->machine);
  const Option* const errors_option =
      add_errors(*command, options->errors, "Also validate an errors file of this machine (*.errors.toml)");
  command->add_flag("--json", options->json, "Print JSON for programs");
  const Option* unit =
      command->add_option("--unit", options->geometry.unit,
                          "Unit of a mesh or point cloud whose file states none: mm (default), m or inch");
  options->geometry.step.add_to(command);
  command->callback([&line, options, machine_option, errors_option, unit] {
    line.run = [options, machine_option, errors_option, unit]() -> int {
      if (options->file.empty() && options->machine.empty()) {
        throw InputError({.field = "file"}, "missing", "the name of a file, or --machine with a machine file");
      }
      if (!options->file.empty()) refuse_if_given(machine_option, "another file is to be checked");
      if (is_geometry_file(options->file)) {
        refuse_if_given(errors_option, "a mesh or a point cloud has no error parameters");
        options->geometry.file = options->file;
        options->geometry.json = options->json;
        return check_geometry(options->geometry);
      }
      if (is_frozen_file(options->file)) {
        const char* const why = "a frozen compensation contains its errors and units";
        for (const Option* const option : {errors_option, unit}) refuse_if_given(option, why);
        options->geometry.step.refuse(why);
        const CheckedFrozenFile frozen = check_frozen_file(read_text_file(options->file), options->file);
        fmt::print("{}", options->json ? json_text(frozen_file_json(frozen)) : frozen_file_text(frozen));
        return kDone;
      }
      if (!options->file.empty() && is_study_file(options->file)) {
        const char* const why = "a study states its machine, errors and units";
        for (const Option* const option : {errors_option, unit}) refuse_if_given(option, why);
        options->geometry.step.refuse(why);
        return check_study_file(options->file, options->json);
      }
      refuse_if_given(unit, "a machine file states its units");
      options->geometry.step.refuse("a machine file has no faces");
      if (options->machine.empty()) {
        require_machine_file(options->file);
        tell_old_form("--machine " + (options->file == kStandardInput ? "-" : options->file));
        options->machine = options->file;
      }
      const Machine machine = read_machine(options->machine);
      nlohmann::ordered_json json = machine_check_json(machine);
      std::size_t coefficients = 0, terms = 0;
      if (!options->errors.empty()) {
        const ErrorsFile errors = read_errors_and_tell(options->errors, machine, StatesOfErrors::allowed);
        terms = errors.errors.motions.size();
        coefficients = errors.errors.parameter_count();
        json["errors"] = {{"motion_terms", terms},
                          {"location_errors", errors.errors.locations.size()},
                          {"parameters", coefficients},
                          {"covariance", errors.covariance.size() > 0},
                          {"distrusted", errors.distrusted}};
      }
      if (options->json) {
        fmt::print("{}", json_text(json));
        return kDone;
      }
      fmt::print("{}", machine_check_text(machine));
      if (!options->errors.empty()) {
        fmt::print("\n{}: {} terms of error motions, {} parameters\n", options->errors, terms, coefficients);
      }
      return kDone;
    };
  });
}

}  // namespace abbe
