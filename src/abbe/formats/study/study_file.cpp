#include "abbe/formats/study/study_file.h"

#include <fmt/format.h>

#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/error_fields.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/study/study_parts.h"

namespace abbe {
namespace {

constexpr std::int64_t kLargestSeed = 1'000'000'000'000'000;
constexpr int kLargestAxisCount = 100'000;

Simulation read_simulation(TomlTable& table, const std::filesystem::path& folder) {
  Simulation simulation;
  if (table.has("errors")) simulation.errors_file = folder / table.text("errors");
  table.text_or("errors", "");
  if (auto generator = table.optional_table("generator")) {
    if (simulation.errors_file) table.fail("generator", "is given together with `errors`", "only one of them");
    ErrorGenerator& options = simulation.generator.emplace();
    options.seed = static_cast<std::uint64_t>(generator->integer_or("seed", 1, 0, kLargestSeed));
    options.linear_order = static_cast<int>(generator->integer_or("linear_order", 4, 0, 50));
    options.rotary_order = static_cast<int>(generator->integer_or("rotary_order", 4, 0, 50));
    options.location_errors = generator->boolean_or("location_errors", true);
    options.mean_volumetric = generator->optional_number("mean_volumetric", Quantity::length);
    options.maximum_volumetric = generator->optional_number("maximum_volumetric", Quantity::length);
    options.reversal = generator->size_or("reversal", Quantity::length, 0);
    options.rotary_reversal = generator->size_or("reversal", Quantity::angle, 0);
    generator->finish();
    if (options.mean_volumetric.has_value() == options.maximum_volumetric.has_value()) {
      generator->fail("", "the size of the errors is missing or given twice",
                      "either mean_volumetric_um or maximum_volumetric_um");
    }
    if (options.mean_volumetric.value_or(1) <= 0 || options.maximum_volumetric.value_or(1) <= 0) {
      generator->fail("", "the size of the errors is not above zero", "a length, for example mean_volumetric_um = 100");
    }
  }
  if (!simulation.errors_file && !simulation.generator) {
    table.fail("", "the true errors are missing", "errors = \"file.errors.toml\" or [simulate.generator]");
  }
  simulation.noise = table.boolean_or("noise", true);
  simulation.interval_s = table.number_or("interval", Quantity::time, 2);
  if (!(simulation.interval_s > 0)) table.fail_quantity("interval", Quantity::time, "is not above zero", "a time");
  if (auto outliers = table.optional_table("outliers")) {
    simulation.outliers.fraction = outliers->size_or("fraction", Quantity::dimensionless, 0);
    if (simulation.outliers.fraction > 0.5) outliers->fail("fraction", "is above one half", "a fraction from 0 to 0.5");
    simulation.outliers.size = outliers->number("size", Quantity::length);
    if (simulation.outliers.size <= 0)
      outliers->fail_quantity("size", Quantity::length, "is not above zero", "a length");
    outliers->finish();
  }
  table.finish();
  return simulation;
}

AxisRange read_axis_range(TomlTable& table, const Axis& axis, bool with_counts, RangeOrder order) {
  const Quantity quantity = axis_quantity(axis);
  AxisRange range;
  if (const auto at = table.optional_number("at", quantity)) {
    if (table.has("range", quantity))
      table.fail_quantity("range", quantity, "is given together with `at`", "only one of them");
    range = AxisRange::fixed(*at);
  } else {
    const auto limits = table.optional_numbers("range", quantity, 2);
    range.from = limits ? (*limits)[0] : axis.travel_min;
    range.to = limits ? (*limits)[1] : axis.travel_max;
    if (with_counts) range.count = static_cast<std::size_t>(table.integer_or("count", 5, 1, kLargestAxisCount));
    range.step = table.size_or("step", quantity, 0);
    if (order == RangeOrder::rising && range.to < range.from) {
      table.fail_quantity("range", quantity, "is falling", "[smallest, largest]; a line or a step diagonal may fall");
    }
    if (range.count == 1 && range.from != range.to) table.fail("count", "is 1 for a range", "2 or more, or `at`");
  }
  for (const double position : {range.from, range.to}) {
    const double tolerance = 1e-9 * (1 + axis.travel_max - axis.travel_min);
    if (axis.endless || (position >= axis.travel_min - tolerance && position <= axis.travel_max + tolerance)) continue;
    const bool linear = axis.kind == AxisKind::linear;
    const Unit& unit = unit_named(quantity, linear ? "mm" : "deg");
    table.fail_quantity(
        range.is_fixed() ? "at" : "range", quantity,
        fmt::format("{:.9g} {} is outside the travel of axis {}", position / unit.factor, unit.suffix, axis.name),
        fmt::format("{:.9g} to {:.9g} {}", axis.travel_min / unit.factor, axis.travel_max / unit.factor, unit.suffix));
  }
  table.finish();
  return range;
}

MapPlan read_map(TomlTable& table, const std::filesystem::path& folder, const Machine& machine) {
  MapPlan map;
  if (table.has("poses")) {
    if (table.has("axis")) table.fail("poses", "is given together with [map.axis]", "only one of them");
    map.poses_file = folder / table.text("poses");
  } else {
    table.text_or("poses", "");
    if (!table.has("axis")) table.fail("", "the poses are missing", "poses = \"poses.csv\" or tables [map.axis.X]");
    map.axes = read_axis_ranges(table, machine, true);
  }
  table.finish();
  return map;
}

ReportOptions read_report(TomlTable& table, const std::filesystem::path& folder) {
  ReportOptions report;
  report.page = table.boolean_or("page", true);
  report.title = table.text_or("title", "");
  report.facts = read_report_facts(table);
  if (table.has("before")) report.before = folder / table.text("before");
  table.text_or("before", "");
  table.finish();
  return report;
}

/// "xcfz" of "xcfz.study.toml".
std::string bare_name(const std::filesystem::path& path) {
  if (path == kStandardInput) return "stdin";
  const std::string name = path.filename().string();
  return name.substr(0, name.find('.'));
}

}  // namespace

std::vector<AxisRange> read_axis_ranges(TomlTable& parent, const Machine& machine, bool with_counts, RangeOrder order) {
  std::vector<AxisRange> ranges;
  for (const Axis& axis : machine.axes) {
    const bool has_zero = axis.endless || (axis.travel_min <= 0 && axis.travel_max >= 0);
    ranges.push_back(AxisRange::fixed(has_zero ? 0 : 0.5 * (axis.travel_min + axis.travel_max)));
  }
  auto tables = parent.optional_table("axis");
  if (!tables) return ranges;
  for (const std::string& name : tables->keys()) {
    const std::size_t axis = machine.find_axis(name);
    if (axis == Machine::npos) {
      tables->fail(name, fmt::format("the machine has no axis {}", name), "one of " + axis_names(machine));
    }
    TomlTable table = tables->table(name);
    ranges[axis] = read_axis_range(table, machine.axes[axis], with_counts, order);
  }
  return ranges;
}

namespace {

/// Intensities of walks are estimated by joint least squares, with the readings' uncertainties as stated.
void refuse_walks_beside_others(const TomlTable& root, const Study& study) {
  if (!study.identification) return;
  const IdentificationPlan& plan = *study.identification;
  const bool plain = plan.loss == LossKind::none && plan.strategy == Strategy::joint &&
                     !plan.estimate_variance_factor && !plan.estimate_pose_noise && !plan.estimate_block_noise;
  for (const Setup& setup : study.setups) {
    if (plain || !setup.drift || !setup.drift->estimate_walk) continue;
    root.fail("identify",
              fmt::format("the random walk of {} is estimated beside other variances, a robust loss or in two steps",
                          setup.name),
              "random_walk = \"stated\"; or strategy, loss, variance_factor, pose_noise and block_noise as by default");
  }
}

}  // namespace

Study parse_study(const std::string& text, const std::filesystem::path& path, const Machine& machine,
                  ReadingsSource source) {
  TomlTable root = TomlTable::parse(text, path.string());
  const std::filesystem::path folder = path.parent_path();
  Study study;
  study.machine = machine;
  study.name = root.text_or("name", bare_name(path));
  study.description = root.text_or("description", "");
  study.machine_file = folder / root.text("machine");
  study.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1, 0, kLargestSeed));
  study.threads = static_cast<int>(root.integer_or("threads", 0, 0, 1024));
  study.output = folder / root.text_or("output", "results/" + bare_name(path));
  if (auto table = root.optional_table("simulate")) study.simulation = read_simulation(*table, folder);
  if (auto table = root.optional_table("plan")) study.planning = read_planning(*table, machine, folder);
  study.channels = read_channel_plan(root, folder, machine);
  for (TomlTable& table : root.tables("setup")) {
    study.setups.push_back(
        read_setup(table, folder, machine, study.simulation.has_value(),
                   study.planning.has_value() || (!study.simulation && source == ReadingsSource::given_later)));
    for (std::size_t i = 0; i + 1 < study.setups.size(); ++i) {
      if (study.setups[i].name != study.setups.back().name) continue;
      table.fail("name", fmt::format("another set-up is called \"{}\"", study.setups[i].name), "different names");
    }
  }
  if (auto table = root.optional_table("identify")) {
    study.identification =
        read_identification(*table, folder, machine, study.simulation ? &*study.simulation : nullptr);
  }
  if (auto table = root.optional_table("map")) study.map = read_map(*table, folder, machine);
  if (auto table = root.optional_table("report")) study.report = read_report(*table, folder);
  root.finish();
  refuse_walks_beside_others(root, study);
  if (study.identification && study.setups.empty()) root.fail("identify", "there are no readings", "a [[setup]]");
  if (study.setups.empty() && !study.map) root.fail("", "nothing to do", "[[setup]] and [identify], or [map]");
  return study;
}

namespace {

/// Files that a study reads later, refused where it names them.
void require_files(TomlTable& root, const std::filesystem::path& folder) {
  const auto require = [&](std::optional<TomlTable> table, const char* key, const char* expected) {
    if (table && table->has(key)) table->file(key, folder, expected);
  };
  const auto require_channels = [&](TomlTable& table) {
    for (const std::string& name : table.texts_or_none("channels")) {
      std::error_code ignored;
      if (std::filesystem::exists(folder / name, ignored)) continue;
      table.fail("channels", fmt::format("there is no file {}", (folder / name).string()), "CSV files of channels");
    }
    for (TomlTable& channel : table.tables("channel")) channel.file("file", folder, "a CSV file of channels");
  };
  require_channels(root);
  for (TomlTable& setup : root.tables("setup")) {
    require_channels(setup);
    for (TomlTable& data : setup.tables("data")) data.file("file", folder, "a file of readings");
  }
  require(root.optional_table("simulate"), "errors", "a file of errors");
  require(root.optional_table("identify"), "initial", "a file of errors");
  require(root.optional_table("identify"), "held_out_file", "a file of readings");
  require(root.optional_table("map"), "poses", "a CSV file of poses");
}

}  // namespace

Study read_study(const std::filesystem::path& path) {
  const std::string text = read_file_of_kind(path, ".study.toml");
  TomlTable root = TomlTable::parse(text, path.string());
  const std::filesystem::path folder = path.parent_path();
  Study study = parse_study(text, path, read_machine(root.file("machine", folder, "a machine file beside the study")));
  require_files(root, folder);
  return study;
}

}  // namespace abbe
