#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"

namespace abbe {

/// Studies of examples/ that simulate their readings: run as they are, and once more from the files of those readings.
class InstrumentStudies : public CommandTest {
 protected:
  /// The text of a simulated study with its readings from `readings/SETUP.csv` instead: without [simulate] and plans,
  /// true values and noise of the simulation.
  static std::string measured_study(const std::string& simulated, const std::string& readings) {
    std::istringstream lines(simulated);
    std::string result, line, setup;
    bool skip = false, in_setup = false;
    const auto finish_setup = [&] {
      if (in_setup) result += "[[setup.data]]\nfile = \"" + readings + "/" + setup + ".csv\"\n\n";
      in_setup = false;
    };
    while (std::getline(lines, line)) {
      if (!line.empty() && line[0] == '[') {
        skip = line.rfind("[simulate", 0) == 0 || line.rfind("[[setup.plan]]", 0) == 0;
        if (line.rfind("[[setup]]", 0) == 0 || line.rfind("[identify]", 0) == 0) finish_setup();
        if (line.rfind("[[setup]]", 0) == 0) in_setup = true, setup.clear();
      }
      if (in_setup && setup.empty() && line.rfind("name = \"", 0) == 0) {
        setup = line.substr(8, line.find('"', 8) - 8);
      }
      if (!skip && line.rfind("true_", 0) != 0) result += line + "\n";
    }
    return result;
  }

  /// Runs examples/EXAMPLE/NAME.study.toml, then the same from its readings, and compares what was identified.
  /// @return summary of the simulated run
  nlohmann::json expect_same_from_files(const std::string& example, const std::string& name) {
    const std::string path = std::string(ABBE_SOURCE_DIR "/examples/") + example;
    const CommandResult first = abbe({"run", path + "/" + name + ".study.toml", "-o", "simulated", "--json"});
    EXPECT_EQ(first.exit_code, 0) << first.err;
    std::ifstream file(path + "/" + name + ".study.toml");
    std::stringstream text;
    text << file.rdbuf();
    std::string measured = measured_study(text.str(), "simulated/readings");
    const std::string relative = "machine = \"../";
    const std::size_t at = measured.find(relative);
    EXPECT_NE(at, std::string::npos);
    measured.replace(at, relative.size(), "machine = \"" + std::string(ABBE_SOURCE_DIR "/examples/"));
    folder.write("measured.study.toml", measured);
    const CommandResult second = abbe({"run", "measured.study.toml", "-o", "read", "--json"});
    EXPECT_EQ(second.exit_code, 0) << second.err;
    if (first.exit_code != 0 || second.exit_code != 0) return {};
    nlohmann::json a = nlohmann::json::parse(first.out);
    const nlohmann::json b = nlohmann::json::parse(second.out);
    EXPECT_EQ(a["readings"], b["readings"]);
    EXPECT_EQ(a["parameters"], b["parameters"]);
    EXPECT_NEAR(a["chi_square"].get<double>(), b["chi_square"].get<double>(), 1e-4 * a["chi_square"].get<double>());
    return a;
  }
};

}  // namespace abbe
