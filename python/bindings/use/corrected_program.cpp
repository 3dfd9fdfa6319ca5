#include "abbe/study/compensation/corrected_program.h"

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/compensation/program_settings.h"
#include "bindings/files.h"
#include "bindings/job.h"
#include "bindings/use/program_result.h"

namespace abbe::python {
namespace {

/// Axes of the program's words. @param words  {"C1": "C"}
WordAxes word_axes(const Machine& machine, const std::map<std::string, std::string>& words) {
  std::vector<std::string> texts;
  for (const auto& [axis, word] : words) texts.push_back(axis + "=" + word);
  return naming_arguments([&] { return program_word_axes(machine, texts); });
}

/// Where the axes of words stand: {"X_mm": 100, "C_deg": 30}.
void set_start(const Machine& machine, const WordAxes& words, const AxisPositions& start, bool tool_centre,
               NcProgramOptions& options) {
  naming_arguments([&] {
    for (const auto& [key, position] : start) {
      const std::string word = key.substr(0, key.rfind('_'));
      // The name of the axis may differ from its word.
      const std::string of_axis = machine.axes[axis_of_word(words, word, key)].name + key.substr(word.size());
      for (const HeldAxis& held : axis_positions(machine, "start", {{of_axis, position}})) {
        set_program_start(machine, words, held, tool_centre, key, options);
      }
    }
  });
}

struct ProgramArguments {
  double tolerance_um = 1, rapid_tolerance_um = 10, orientation_tolerance_urad = 10;
  std::optional<double> limit_um;
  double reversal_dead_band_um = 0, leave_out = 0, largest_turn_deg = 0.5;
  std::map<std::string, std::string> words;
  AxisPositions start;
  std::optional<NcToolTable> tools;
  std::optional<int> tool;
  std::map<int, double> parameters;
  bool parameters_in_inches = false, tool_centre = false, inches = false, block_delete = false;
  int decimals = 6;
  std::vector<std::string> allow;
  std::optional<double> max_output_mb, max_minutes;
  bool accept_misfit = false;
  std::string errors_file;
};

ProgramRequest request_of(const MachineErrors& errors, const std::string& program_file, const ProgramArguments& given) {
  require_trusted(errors, given.accept_misfit, given.errors_file);
  if (given.decimals < 0 || given.decimals > 9) {
    throw InputError({.field = "decimals"}, fmt::format("is {}", given.decimals), "0 to 9");
  }
  ProgramRequest request;
  request.machine = errors.machine;
  request.errors = errors.set();
  request.covariance = errors.file.covariance;
  request.program_file = program_file;
  request.errors_file = given.errors_file;
  request.words = word_axes(request.machine, given.words);
  NcProgramOptions& text = request.text;
  for (std::size_t i = 0; i < kAxisWords; ++i) text.words[i] = request.words.axis[i] != Machine::npos;
  set_start(request.machine, request.words, given.start, given.tool_centre, text);
  text.parameters = given.parameters;
  text.parameters_in_inches = given.parameters_in_inches;
  text.tools = given.tools;
  text.tool = given.tool;
  text.inches = given.inches;
  text.block_delete = given.block_delete;
  text.decimals_mm = text.decimals_deg = given.decimals;
  text.batch = 1 << 14;
  request.tool_centre = given.tool_centre;
  request.correction.tolerance.position = 1e-3 * given.tolerance_um;
  request.correction.rapid_tolerance = 1e-3 * given.rapid_tolerance_um;
  request.correction.tolerance.orientation = 1e-6 * given.orientation_tolerance_urad;
  request.correction.inverse.largest_turn = kDegree * given.largest_turn_deg;
  request.correction.reversal_dead_band = 1e-3 * given.reversal_dead_band_um;
  request.leave_out_factor = given.leave_out;
  request.allowed = naming_arguments([&] { return allowed_problems(given.allow); });
  request.limit_um = given.limit_um;
  return request;
}

/// The limits of the command: what a program of that size can become and take.
ProgramLimits limits(const ProgramArguments& given, std::size_t size) {
  const ProgramLimits usual = default_program_limits(size);
  return {given.max_output_mb.value_or(usual.megabytes), given.max_minutes.value_or(usual.minutes)};
}

CorrectedProgram run(const nb::object& progress, const ProgramRequest& request, std::string_view program,
                     const std::function<void(std::string_view)>& write, const std::function<void(std::size_t)>& done) {
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] {
      return correct_program(
          request, program, write,
          [&](std::size_t end) {
            control.progress("correcting the program", end, program.size());
            if (done) done(end);
          },
          control.stop);
    });
  });
}

ProgramResult result_of(const ProgramRequest& request, const ProgramArguments& given, CorrectedProgram made) {
  return {.machine = request.machine,
          .corrected = std::move(made),
          .program_file = request.program_file,
          .output = {},
          .text = {},
          .tolerance_um = given.tolerance_um,
          .leave_out_factor = given.leave_out};
}

ProgramResult of_text(const MachineErrors& errors, const nb::object& text, const std::string& program_file,
                      const nb::object& progress, const ProgramArguments& given) {
  const std::string program = bytes_of_text(text, "program");
  ProgramRequest request = request_of(errors, program_file, given);
  request.limits = limits(given, program.size());
  std::string corrected;
  ProgramResult result = result_of(
      request, given, run(progress, request, program, [&](std::string_view piece) { corrected += piece; }, {}));
  if (result.corrected.refused.empty()) result.text = std::move(corrected);
  return result;
}

ProgramResult of_file(const MachineErrors& errors, const std::filesystem::path& path,
                      const std::optional<std::filesystem::path>& output, bool overwrite, const nb::object& progress,
                      const ProgramArguments& given) {
  if (output) {
    refuse_existing(*output, overwrite);
    std::error_code none;
    if (std::filesystem::equivalent(path, *output, none)) {
      throw InputError({.file = output->string(), .field = "output"}, "is the program itself", "another file");
    }
  }
  ProgramRequest request = request_of(errors, path.string(), given);
  MappedFile program(path.string());
  request.limits = limits(given, program.text().size());
  std::optional<StreamedFile> out;
  if (output) out.emplace(*output);
  ProgramResult result = result_of(request, given,
                                   run(
                                       progress, request, program.text(),
                                       [&](std::string_view piece) {
                                         if (out) out->append(piece);
                                       },
                                       [&](std::size_t end) { program.forget(end); }));
  if (output) result.output = output->string();
  if (out && result.corrected.refused.empty()) out->commit();
  return result;
}

}  // namespace

void bind_corrected_program(nb::module_& module) {
  bind_program_result(module);
  constexpr const char* kOptions =
      "tolerance_um, rapid_tolerance_um, orientation_tolerance_urad: largest distance of the actual tool from the\n"
      "commanded path between corrected poses. limit_um: larger corrections are refused. reversal_dead_band_um: an\n"
      "axis with a reversal value counts as reversed once it has come back by more. words: {'C1': 'C'}, words of axes\n"
      "in the program. start: {'X_mm': 100, 'C_deg': 30}, where words stand when the program begins. tools: offsets\n"
      "of read_nc_tools(), for G43 H; tool: number of the one in the spindle. parameters: of read_nc_parameters(),\n"
      "for work offsets. tool_centre: X Y Z are the functional point in the workpiece frame throughout. allow: what "
      "is\n"
      "written all the same: 'not-covered', 'outside-travel', 'held-start', 'position-left', 'not-converged',\n"
      "'not-proven'. progress: a function of the step, the bytes done and their number. Raises InputError with line\n"
      "and word for what cannot be handled. Method and proof: docs/programs.md.";
  module.def(
      "correct_program",
      [](const MachineErrors& errors, const nb::object& program, double tolerance_um, double rapid_tolerance_um,
         double orientation_tolerance_urad, std::optional<double> limit_um, double reversal_dead_band_um,
         double leave_out, double largest_turn_deg, std::map<std::string, std::string> words, AxisPositions start,
         std::optional<NcToolTable> tools, std::optional<int> tool, std::map<int, double> parameters,
         bool parameters_in_inches, bool tool_centre, bool inches, bool block_delete, int decimals,
         std::vector<std::string> allow, std::optional<double> max_output_mb, std::optional<double> max_minutes,
         bool accept_misfit, std::string errors_file, const std::string& program_file, const nb::object& progress) {
        return of_text(errors, program, program_file, progress,
                       {tolerance_um,
                        rapid_tolerance_um,
                        orientation_tolerance_urad,
                        limit_um,
                        reversal_dead_band_um,
                        leave_out,
                        largest_turn_deg,
                        std::move(words),
                        std::move(start),
                        std::move(tools),
                        tool,
                        std::move(parameters),
                        parameters_in_inches,
                        tool_centre,
                        inches,
                        block_delete,
                        decimals,
                        std::move(allow),
                        max_output_mb,
                        max_minutes,
                        accept_misfit,
                        std::move(errors_file)});
      },
      nb::arg("errors"), nb::arg("program"), nb::kw_only(), nb::arg("tolerance_um") = 1.0,
      nb::arg("rapid_tolerance_um") = 10.0, nb::arg("orientation_tolerance_urad") = 10.0,
      nb::arg("limit_um") = nb::none(), nb::arg("reversal_dead_band_um") = 0.0,
      nb::arg("leave_out_below_uncertainty") = 0.0, nb::arg("largest_turn_deg") = 0.5,
      nb::arg("words") = std::map<std::string, std::string>{}, nb::arg("start") = AxisPositions{},
      nb::arg("tools") = nb::none(), nb::arg("tool") = nb::none(), nb::arg("parameters") = std::map<int, double>{},
      nb::arg("parameters_in_inches") = false, nb::arg("tool_centre") = false, nb::arg("inches") = false,
      nb::arg("block_delete") = false, nb::arg("decimals") = 6, nb::arg("allow") = std::vector<std::string>{},
      nb::arg("max_output_mb") = nb::none(), nb::arg("max_minutes") = nb::none(), nb::arg("accept_misfit") = false,
      nb::arg("errors_file") = "errors.toml", nb::arg("program_file") = "program.ngc", nb::arg("progress") = nb::none(),
      (std::string("Corrects an NC program (RS274/NGC, ISO 6983) given as text or bytes: the actual tool follows the\n"
                   "commanded path within a tolerance.\n\n") +
       kOptions +
       "\n\n>>> import abbe\n"
       ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
       ">>> errors = abbe.Errors(mill)\n"
       ">>> errors.add_location('EC0Y', value_urad=20)\n"
       ">>> result = abbe.correct_program(errors, 'G0 X0 Y0 Z0\\nG1 X100 Y100 F500\\nM30\\n', decimals=4)\n"
       ">>> print(result.program, end='')\n"
       "G21 G90 G0 X0.0000 Y0.0000 Z0.0000\n"
       "G94 G1 X100.0020 Y100.0000 F500\n"
       "M30\n")
          .c_str());
  module.def(
      "correct_program_file",
      [](const MachineErrors& errors, const std::filesystem::path& path,
         const std::optional<std::filesystem::path>& output, bool overwrite, double tolerance_um,
         double rapid_tolerance_um, double orientation_tolerance_urad, std::optional<double> limit_um,
         double reversal_dead_band_um, double leave_out, double largest_turn_deg,
         std::map<std::string, std::string> words, AxisPositions start, std::optional<NcToolTable> tools,
         std::optional<int> tool, std::map<int, double> parameters, bool parameters_in_inches, bool tool_centre,
         bool inches, bool block_delete, int decimals, std::vector<std::string> allow,
         std::optional<double> max_output_mb, std::optional<double> max_minutes, bool accept_misfit,
         std::string errors_file, const nb::object& progress) {
        return of_file(errors, path, output, overwrite, progress,
                       {tolerance_um,
                        rapid_tolerance_um,
                        orientation_tolerance_urad,
                        limit_um,
                        reversal_dead_band_um,
                        leave_out,
                        largest_turn_deg,
                        std::move(words),
                        std::move(start),
                        std::move(tools),
                        tool,
                        std::move(parameters),
                        parameters_in_inches,
                        tool_centre,
                        inches,
                        block_delete,
                        decimals,
                        std::move(allow),
                        max_output_mb,
                        max_minutes,
                        accept_misfit,
                        std::move(errors_file)});
      },
      nb::arg("errors"), nb::arg("path"), nb::arg("output") = nb::none(), nb::kw_only(), nb::arg("overwrite") = false,
      nb::arg("tolerance_um") = 1.0, nb::arg("rapid_tolerance_um") = 10.0, nb::arg("orientation_tolerance_urad") = 10.0,
      nb::arg("limit_um") = nb::none(), nb::arg("reversal_dead_band_um") = 0.0,
      nb::arg("leave_out_below_uncertainty") = 0.0, nb::arg("largest_turn_deg") = 0.5,
      nb::arg("words") = std::map<std::string, std::string>{}, nb::arg("start") = AxisPositions{},
      nb::arg("tools") = nb::none(), nb::arg("tool") = nb::none(), nb::arg("parameters") = std::map<int, double>{},
      nb::arg("parameters_in_inches") = false, nb::arg("tool_centre") = false, nb::arg("inches") = false,
      nb::arg("block_delete") = false, nb::arg("decimals") = 6, nb::arg("allow") = std::vector<std::string>{},
      nb::arg("max_output_mb") = nb::none(), nb::arg("max_minutes") = nb::none(), nb::arg("accept_misfit") = false,
      nb::arg("errors_file") = "errors.toml", nb::arg("progress") = nb::none(),
      (std::string("Corrects an NC program of any size from file to file; without output only the report is made.\n\n"
                   "Nothing is written if the program is refused. An existing file is only replaced with "
                   "overwrite=True.\n\n") +
       kOptions)
          .c_str());
  module.def(
      "read_nc_tools", [](const std::filesystem::path& path, bool in_inches) { return read_nc_tools(path, in_inches); },
      nb::arg("path"), nb::arg("in_inches") = false,
      "Offsets [9] of the tools of a LinuxCNC tool table by their numbers: mm, rad.");
  module.def("read_nc_parameters", &read_nc_parameters, nb::arg("path"),
             "Parameters of a LinuxCNC parameter file (.var) by their numbers.");
}

}  // namespace abbe::python
