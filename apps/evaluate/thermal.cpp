#include "abbe/formats/study/study_file.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "options.h"

namespace abbe {
namespace {

const std::string kSensorColumns =
    "  time_min        or time_s, time_h\n"
    "  NAME_um         displacement of a sensor of any name, such as X1_um, Z_um; or NAME_mm\n"
    "  NAME_urad       angle, such as A_urad\n"
    "  NAME_degC       temperature, such as air_degC";

/// A thermal test with the numbers that its library lists. @param read  enters the readings of a file
template <class Test, class Read>
void add_test(Subcommand& evaluate, CommandLine& line, const std::string& kind, const std::string& description,
              const std::string& columns, const std::string& example, std::span<const TestNumber<Test>> numbers,
              const Read& read) {
  auto options = std::make_shared<EvaluationOptions>();
  auto stated = std::make_shared<Test>();
  Subcommand* app = add_evaluation(evaluate, kind, description, columns, "Z_um=probe",
                                   "  abbe evaluate " + kind + " examples/" + example, *options);
  add_customer_report_options(*app, *options);
  for (const auto& one : numbers)
    app->add_option(one.option, (*stated).*one.value, one.words)->check(in_range(one.from, one.to));
  app->callback([&line, options, stated, numbers, read] {
    line.run = [options, stated, numbers, read] {
      return run_evaluation(*options, [&](const std::string& file) {
        Test test = *stated;
        read(file, options->columns.mapping(), test);
        for (const auto& one : numbers) test.*one.value *= one.unit;
        return test;
      });
    };
  });
}

}  // namespace

void add_evaluate_thermal(Subcommand& evaluate, CommandLine& line) {
  const auto sensors = [](const std::string& file, const ColumnMapping& mapping, auto& test) {
    test.readings = read_thermal(file, mapping);
  };
  add_test(evaluate, line, "etve", "Environmental temperature variation error (ISO 230-3)", kSensorColumns,
           "evaluate/etve.csv --plane-distance-mm 150 --u-reading-um 0.1", etve_numbers(), sensors);
  add_test(evaluate, line, "spindle-distortion", "Thermal distortion by a rotating spindle (ISO 230-3)", kSensorColumns,
           "evaluate/spindle.csv --stop-min 240", spindle_distortion_numbers(), sensors);
  add_test(
      evaluate, line, "axis-distortion", "Thermal distortion by a moving linear axis (ISO 230-3)",
      "  target_mm       position at which the axis was read\n"
      "  deviation_um    actual minus target; or actual_mm\n"
      "  direction       optional, + or -: side from which the target was approached\n" +
          kSensorColumns,
      "evaluate/axis_warming.csv --tolerance d_L_um=20", axis_distortion_numbers(),
      [](const auto& file, const auto& mapping, auto& test) { test.readings = read_axis_distortion(file, mapping); });
  add_test(evaluate, line, "location-distortion",
           "Thermal distortion of location errors, from poses that any instrument reads repeatedly (ISO 230-3)", "",
           "warm_up/r-test.study.toml --stop-min 240", location_distortion_numbers(),
           [](const std::string& file, const ColumnMapping&, LocationDistortionTest& test) {
             test.campaign = gather_readings(test.study = read_study(file));
           });
}

}  // namespace abbe
