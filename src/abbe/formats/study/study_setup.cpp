#include <fmt/format.h>

#include <set>

#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_parts.h"

namespace abbe {
namespace {

SetupData read_data(TomlTable& table, const std::filesystem::path& folder) {
  SetupData data;
  data.file = folder / table.text("file");
  data.mapping = read_column_mapping(table);
  table.finish();
  return data;
}

/// The readings of a file name their item, so that every item needs a name of its own.
void refuse_same_items(const TomlTable& table, const Instrument& device) {
  std::set<std::string> names;
  for (const InstrumentItem& item : device.items()) {
    if (!names.insert(item.name).second) {
      table.fail("", fmt::format("two items are called \"{}\"", item.name), "different names");
    }
  }
}

/// Names of what can be measured at a position, and of where it can be measured from.
PlanNames plan_names(const Instrument& device) {
  PlanNames names;
  names.one = device.target_word();
  names.key = names.one + "s";
  names.targets = device.target_names();
  names.stations = device.station_names();
  return names;
}

}  // namespace

Setup read_setup(TomlTable& table, const std::filesystem::path& folder, const Machine& machine, bool simulated,
                 bool later) {
  Setup setup;
  setup.name = table.file_name("name");
  const std::vector<std::string_view> words = instrument_words();
  setup.instrument = words[table.word("instrument", words)];
  setup.noise_from_data = table.boolean_or("noise_from_data", false);
  if (setup.noise_from_data && simulated) {
    table.fail("noise_from_data", "a simulation has no data", "[setup.noise]");
  }
  setup.device = instrument_form(setup.instrument).read(table, {setup.name, machine, simulated, setup.noise_from_data});
  refuse_same_items(table, *setup.device);
  const PlanNames names = plan_names(*setup.device);
  for (TomlTable& plan : table.tables("plan")) {
    if (!simulated) table.fail("plan", "belongs to a simulation only", "[simulate], or [[setup.data]]");
    if (names.targets.empty()) {
      table.fail("", fmt::format("the {} are missing", names.key), fmt::format("[[setup.{}]]", names.one));
    }
    setup.plans.push_back(read_plan(plan, folder, machine, names));
  }
  for (TomlTable& data : table.tables("data")) {
    if (simulated) table.fail("data", "is given together with [simulate]", "only one of them");
    setup.data.push_back(read_data(data, folder));
  }
  setup.channels = read_channel_plan(table, folder, machine);
  setup.drift = read_drift(table, simulated);
  if (setup.plans.empty() && setup.data.empty() && !later) {
    table.fail("", "the readings are missing", simulated ? "[[setup.plan]]" : "[[setup.data]] with a file");
  }
  table.finish();
  return setup;
}

}  // namespace abbe
