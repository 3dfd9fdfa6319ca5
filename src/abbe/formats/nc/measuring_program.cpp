#include "abbe/formats/nc/measuring_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "abbe/formats/nc/measuring_dialect.h"
#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

/// Writes readings one after the other, in the words of a control.
class MeasuringProgramWriter {
 public:
  MeasuringProgramWriter(const Machine& machine, const MeasuringProgramOptions& options, MeasuringDialect& dialect)
      : machine_(machine),
        options_(options),
        dialect_(dialect),
        decimals_(options.decimals.value_or(default_decimals(options.dialect))),
        last_(machine.axes.size()) {}

  std::string write(const std::vector<MeasuringSection>& sections) {
    dialect_.begin(options_);
    for (const std::string& line : options_.comments) dialect_.comment(line);
    for (const MeasuringSection& section : sections) {
      if (sections.size() > 1) dialect_.stop(section.words);
      for (const MeasuringStop& stop : section.stops) reading(stop);
    }
    dialect_.end(options_);
    return dialect_.text();
  }

 private:
  void reading(const MeasuringStop& stop) {
    dialect_.comment(stop.words);
    for (const std::vector<double>& pose : stop.via) move(pose);
    move(stop.pose);
    dialect_.dwell(options_.dwell);
    switch (options_.trigger) {
      case NcTrigger::dwell:
        break;
      case NcTrigger::m_function:
        dialect_.m_function(*options_.number);
        break;
      case NcTrigger::output:
        dialect_.output(*options_.number, true);
        dialect_.dwell(options_.pulse);
        dialect_.output(*options_.number, false);
        break;
    }
    if (options_.reading > 0) dialect_.dwell(options_.reading);
  }

  void move(const std::vector<double>& pose) {
    std::vector<StatedWord> words;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      std::string value = fixed_number(in_degrees_or_mm(machine_.axes[i], pose[i]), decimals_);
      if (value == last_[i]) continue;
      words.push_back({measuring_word(machine_.axes[i], options_), value});
      last_[i] = std::move(value);
    }
    if (!words.empty()) dialect_.move(words, options_);
  }

  const Machine& machine_;
  const MeasuringProgramOptions& options_;
  MeasuringDialect& dialect_;
  int decimals_;
  std::vector<std::string> last_;  ///< [axes] value that the program stated last
};

bool is_trigger_function(int number) {
  return number > 2 && number <= 99999 && number != 30 && number != 98 && number != 99;
}

struct OutputRange {
  int first, last;
  const char* words;
};

OutputRange output_range(NcDialect dialect) {
  if (dialect == NcDialect::siemens) return {1, 1000, "1 to 1000: the index of $A_OUT"};
  if (dialect == NcDialect::fanuc) return {1100, 1131, "1100 to 1131: the macro variables of UO0 to UO31"};
  return {0, 63, "0 to 63: motion.digital-out-NN"};
}

void check_trigger_number(const MeasuringProgramOptions& options) {
  if (options.trigger == NcTrigger::dwell) {
    if (!options.number) return;
    throw InputError({.field = "--trigger-number"}, "has no effect without a trigger",
                     "--trigger m-function or --trigger output with it");
  }
  if (options.number) return;
  throw InputError({.field = "--trigger-number"}, "missing",
                   options.trigger == NcTrigger::output ? "the number of the output" : "the number of the M function");
}

/// What the control cannot do.
void check_options(const MeasuringProgramOptions& options) {
  const std::string dialect = nc_dialect_names()[static_cast<std::size_t>(options.dialect)];
  if (options.trigger == NcTrigger::output &&
      (options.dialect == NcDialect::iso || options.dialect == NcDialect::heidenhain)) {
    throw InputError({.field = "--trigger output"}, "the dialect " + dialect + " has no words for an output",
                     "--trigger m-function with an M function of the machine's maker, or dwell");
  }
  check_trigger_number(options);
  if (options.trigger == NcTrigger::m_function && !is_trigger_function(*options.number)) {
    throw InputError({.field = "--trigger-number"},
                     fmt::format("M{} stops or ends programs, or calls them", *options.number),
                     "an M function of the machine's maker from M3 to M99999, but M30, M98 and M99");
  }
  if (options.trigger == NcTrigger::output) {
    const OutputRange range = output_range(options.dialect);
    if (*options.number < range.first || *options.number > range.last) {
      throw InputError({.field = "--trigger-number"},
                       fmt::format("{} is no output of the dialect {}", *options.number, dialect), range.words);
    }
  }
  if (options.feed > 0) static_cast<void>(feed_text(options.feed));
  if (options.dialect == NcDialect::fanuc && options.machine_coordinates && options.feed > 0) {
    throw InputError({.field = "--feed-mm-per-min"}, "G53 of the dialect fanuc is always a rapid move",
                     "no feed, or no --machine-coordinates");
  }
}

/// The value whose name has this place among the names of all.
template <class Value>
std::optional<Value> value_named(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Value>(found - names.begin());
}

}  // namespace

const std::vector<std::string>& nc_dialect_names() {
  static const std::vector<std::string> names = {"iso", "linuxcnc", "heidenhain", "siemens", "fanuc"};
  return names;
}

std::optional<NcDialect> nc_dialect(const std::string& name) {
  return value_named<NcDialect>(nc_dialect_names(), name);
}

const std::vector<std::string>& nc_trigger_names() {
  static const std::vector<std::string> names = {"dwell", "m-function", "output"};
  return names;
}

std::optional<NcTrigger> nc_trigger(const std::string& name) {
  return value_named<NcTrigger>(nc_trigger_names(), name);
}

std::string nc_program_name(const std::string& file) {
  std::string name;
  for (const char c : std::filesystem::path(file).stem().string()) {
    name += is_letter(c) || is_digit(c) ? upper_case(c) : '_';
  }
  constexpr std::size_t kLongestName = 24;
  return name.empty() ? "MEASURE" : name.substr(0, kLongestName);
}

int default_decimals(NcDialect dialect) {
  switch (dialect) {
    case NcDialect::heidenhain:
    case NcDialect::siemens:
      return 4;
    case NcDialect::fanuc:
      return 3;
    default:
      return 6;
  }
}

std::vector<double> stated_pose(const Machine& machine, const std::vector<double>& pose, int decimals) {
  const double digits = std::pow(10.0, decimals);
  std::vector<double> stated = pose;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const double unit = position_unit(machine.axes[i]);
    double steps = std::round(pose[i] / unit * digits);
    // At the end of a travel that has more digits, the next step within it.
    const Axis& axis = machine.axes[i];
    if (!axis.endless && pose[i] <= axis.travel_max && steps / digits * unit > axis.travel_max) steps -= 1;
    if (!axis.endless && pose[i] >= axis.travel_min && steps / digits * unit < axis.travel_min) steps += 1;
    stated[i] = steps / digits * unit;
  }
  return stated;
}

std::string measuring_program(const Machine& machine, const std::vector<MeasuringSection>& sections,
                              const MeasuringProgramOptions& options) {
  check_options(options);
  for (const Axis& axis : machine.axes) static_cast<void>(measuring_word(axis, options));
  const std::unique_ptr<MeasuringDialect> dialect = measuring_dialect(options.dialect);
  return MeasuringProgramWriter(machine, options, *dialect).write(sections);
}

}  // namespace abbe
