// Files for Aerotech controls, looked up as their description says by a reader that is written here from it alone.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "abbe/controls/control_table.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/verify/error_map.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// A table of the file: places along a row and a column axis; a 1-D table has one row.
struct Looked {
  std::array<int, 2> axis{};       ///< row, column: numbers of axes, from 1
  std::array<double, 2> step{};    ///< mm
  std::array<double, 2> offset{};  ///< mm
  std::vector<int> outputs;
  std::size_t columns = 0;
  std::vector<double> values;

  double value(double row, double column, std::size_t output) const {
    const std::size_t rows = values.size() / (columns * outputs.size());
    const auto place = [](double along, double added, double spacing, std::size_t count) {
      return std::clamp((along + added) / spacing, 0.0, static_cast<double>(count) - 1);
    };
    const double r = rows < 2 ? 0 : place(row, offset[0], step[0], rows);
    const double c = place(column, offset[1], step[1], columns);
    const auto at = [&](double i, double j) {
      const auto index = static_cast<std::size_t>(i) * columns + static_cast<std::size_t>(j);
      return values[index * outputs.size() + output];
    };
    const double r0 = std::floor(r), c0 = std::floor(c);
    const double r1 = std::min(r0 + 1, static_cast<double>(rows) - 1);
    const double c1 = std::min(c0 + 1, static_cast<double>(columns) - 1);
    const double lower = at(r0, c0) + (c - c0) * (at(r0, c1) - at(r0, c0));
    const double upper = at(r1, c0) + (c - c0) * (at(r1, c1) - at(r1, c0));
    return lower + (r - r0) * (upper - lower);
  }
};

std::map<std::string, std::string> keys_of(std::istringstream& line) {
  std::map<std::string, std::string> keys;
  for (std::string word; line >> word;) {
    const std::size_t equals = word.find('=');
    keys[word.substr(0, equals)] = equals == std::string::npos ? "" : word.substr(equals + 1);
  }
  return keys;
}

std::vector<Looked> tables_in(const std::string& text) {
  std::vector<Looked> tables;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    if (line.rfind(":START2D ", 0) == 0) {
      std::string keyword;
      words >> keyword;
      if (std::isdigit(static_cast<unsigned char>(line[9])) != 0) {
        Looked& table = tables.emplace_back();
        table.outputs.resize(2);
        words >> table.axis[0] >> table.axis[1] >> table.outputs[0] >> table.outputs[1] >> table.step[0] >>
            table.step[1] >> table.columns;
        continue;
      }
      std::map<std::string, std::string> keys = keys_of(words);
      Looked& table = tables.back();
      if (keys.count("OUTAXIS3") != 0) table.outputs.push_back(std::stoi(keys["OUTAXIS3"]));
      table.offset = {std::stod(keys.at("OFFSETROW")), std::stod(keys.at("OFFSETCOL"))};
      EXPECT_EQ(keys.at("POSUNIT") + keys.at("CORUNIT"), "PRIMARYPRIMARY");
    } else if (line.rfind(":START ", 0) == 0) {
      std::string keyword;
      Looked& table = tables.emplace_back();
      table.outputs.resize(1);
      words >> keyword >> table.outputs[0];
      std::map<std::string, std::string> keys = keys_of(words);
      table.axis[1] = keys.count("MASTER") != 0 ? std::stoi(keys["MASTER"]) : table.outputs[0];
      table.step[1] = std::stod(keys.at("SAMPLEDIST"));
      table.offset[1] = std::stod(keys.at("OFFSET"));
      EXPECT_EQ(keys.at("POSUNIT") + keys.at("CORUNIT"), "PRIMARYPRIMARY");
    } else if (line != ":END") {
      for (double value = 0; words >> value;) tables.back().values.push_back(value);
      EXPECT_TRUE(words.eof()) << line;
    }
  }
  for (Looked& table : tables) {
    if (table.columns == 0) table.columns = table.values.size();
    EXPECT_EQ(table.values.size() % (table.columns * table.outputs.size()), 0U);
  }
  return tables;
}

/// Commands with what the tables add; axes are numbered in the order X, Y, Z.
std::vector<double> corrected(const std::vector<Looked>& tables, const Machine& machine, std::vector<double> pose) {
  const std::vector<double> commands = pose;
  const auto index = [&](int number) { return machine.find_axis(std::string(1, "XYZ"[number - 1])); };
  for (const Looked& table : tables) {
    const double row = table.axis[0] > 0 ? commands[index(table.axis[0])] : 0;
    const double column = commands[index(table.axis[1])];
    for (std::size_t o = 0; o < table.outputs.size(); ++o) {
      pose[index(table.outputs[o])] += table.value(row, column, o);
    }
  }
  return pose;
}

/// Distance of the actual tool at some commands from the nominal one at others; mm.
double off_by(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
              const std::vector<double>& wanted) {
  return (actual_workpiece_from_tool(machine, errors, commands).translation -
          nominal_workpiece_from_tool(machine, wanted).translation)
      .norm();
}

ControlTableRequest mill_request(const std::string& format) {
  const std::string examples = std::string(ABBE_SOURCE_DIR) + "/examples/";
  ControlTableRequest request;
  request.format = format;
  request.machine = read_machine(examples + "machines/three-axis-mill.machine.toml");
  request.errors = read_errors(examples + "compensate/mill.errors.toml", request.machine).errors;
  request.positions = 7;
  return request;
}

/// A stage of two axes with the errors that a grid plate shows, and an angle whose lever is the height of the tool.
ControlTableRequest stage_request(const std::string& format) {
  ControlTableRequest request;
  request.format = format;
  request.machine = parse_machine(
      "name = \"stage\"\nchain = \"w X' Y' b t\"\n[axis.X]\ntravel_mm = [-150, 150]\n[axis.Y]\n"
      "travel_mm = [-100, 200]\n[tool]\nreference_mm = [0, 0, 250]\noffset_mm = [0, 0, -100]\n",
      "stage.machine.toml");
  const std::string text =
      "chain = \"w X' Y' b t\"\n"
      "[[motion]]\nname = \"EXX\"\nbasis = \"legendre\"\norder = 3\ncoefficients_um = [0, 4, -2, 1]\n"
      "[[motion]]\nname = \"EYX\"\nbasis = \"legendre\"\norder = 3\ncoefficients_um = [0, 0, 1.5, 0.5]\n"
      "[[motion]]\nname = \"ECX\"\nbasis = \"legendre\"\norder = 2\ncoefficients_urad = [0, 20, -8]\n"
      "[[motion]]\nname = \"EBX\"\nbasis = \"legendre\"\norder = 2\ncoefficients_urad = [0, 12, 5]\n"
      "[[motion]]\nname = \"EYY\"\nbasis = \"legendre\"\norder = 3\ncoefficients_um = [0, -3, 2, 1]\n"
      "[[motion]]\nname = \"EXY\"\nbasis = \"legendre\"\norder = 3\ncoefficients_um = [0, 0, -2, 1]\n"
      "[[motion]]\nname = \"ECY\"\nbasis = \"legendre\"\norder = 2\ncoefficients_urad = [0, -15, 6]\n"
      "[[location]]\nname = \"EC0Y\"\nvalue_urad = 45\n";
  request.errors = parse_errors(text, "stage.errors.toml", request.machine).errors;
  request.positions = 21;
  return request;
}

std::vector<Looked> looked_up(const ControlTableRequest& request, ControlTables& made) {
  made = make_control_tables(request);
  EXPECT_FALSE(made.says_no()) << testing::PrintToString(made.refused) << made.too_few_nodes;
  EXPECT_EQ(made.files.size(), 1U);
  return made.files.empty() ? std::vector<Looked>() : tables_in(made.files[0].text);
}

TEST(AerotechPlanes, BringTheToolOfAMillToItsNominalPlaceInTheWholeVolume) {
  ControlTableRequest request = mill_request("aerotech-2d");
  request.tolerance_mm = 0.5e-3;
  ControlTables made;
  const std::vector<Looked> tables = looked_up(request, made);
  ASSERT_EQ(tables.size(), 3U);
  double before = 0, after = 0;
  for (std::size_t k = 0; k < made.poses.count(); ++k) {
    const std::vector<double> pose = made.poses.pose(k);
    before = std::max(before, off_by(request.machine, request.errors, pose, pose));
    const double left = off_by(request.machine, request.errors, corrected(tables, request.machine, pose), pose);
    after = std::max(after, left);
    EXPECT_NEAR(left, made.after.position[k], 1e-6) << "the report says what the file does";
  }
  EXPECT_GT(before, 0.05);
  // The limit of the interpolation in three axes, and products of errors.
  EXPECT_LT(after, std::sqrt(3.0) * *request.tolerance_mm + 5e-5);
  EXPECT_GT(after, 1e-5);
  for (const CarriedError& error : made.errors) EXPECT_GT(error.carried(), 0.95) << error.name;
  // Beyond the ends of the tables their end values hold.
  const std::vector<double> end = {0, 440, 0}, beyond = {-5, 450, 3};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(corrected(tables, request.machine, beyond)[i] - beyond[i],
                corrected(tables, request.machine, end)[i] - end[i], 1e-12);
  }
}

TEST(AerotechPlanes, OfAStageAreOneTableOfTwoAxesAndLeaveTheToolWithinTheInterpolation) {
  ControlTableRequest request = stage_request("aerotech-2d");
  ControlTables made;
  const std::vector<Looked> tables = looked_up(request, made);
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_EQ(tables[0].axis, (std::array<int, 2>{2, 1}));
  EXPECT_EQ(tables[0].outputs, (std::vector<int>{1, 2}));
  EXPECT_EQ(tables[0].offset, (std::array<double, 2>{100, 150}));
  double before = 0;
  for (std::size_t k = 0; k < made.poses.count(); ++k) {
    const std::vector<double> pose = made.poses.pose(k), with = corrected(tables, request.machine, pose);
    // Two axes cannot take what is across their plane.
    const Eigen::Vector3d left = actual_workpiece_from_tool(request.machine, request.errors, with).translation -
                                 nominal_workpiece_from_tool(request.machine, pose).translation;
    before = std::max(before, off_by(request.machine, request.errors, pose, pose));
    EXPECT_LT(left.head<2>().norm(), std::sqrt(2.0) * 1e-4 + 1e-6);
    EXPECT_NEAR(left.norm(), made.after.position[k], 1e-6);
  }
  EXPECT_GT(before, 0.008);
}

TEST(AerotechPlanes, WithTheOtherSignHoldTheSameNumbersAndAreJudgedTheSame) {
  ControlTableRequest request = stage_request("aerotech-2d");
  ControlTables plain, turned;
  const std::vector<Looked> tables = looked_up(request, plain);
  request.negate = true;
  const std::vector<Looked> others = looked_up(request, turned);
  ASSERT_EQ(others.size(), tables.size());
  for (std::size_t k = 0; k < tables[0].values.size(); ++k) EXPECT_EQ(others[0].values[k], -tables[0].values[k]);
  EXPECT_EQ(turned.after.position, plain.after.position);
}

TEST(AerotechPlanes, OverTwoOfThreeAxesHoldWhereTheThirdStands) {
  ControlTableRequest request = mill_request("aerotech-2d");
  request.tolerance_mm = 0.5e-3;
  request.axes = {"X", "Z"};
  request.reference = {{request.machine.find_axis("Y"), 100}};
  ControlTables made;
  const std::vector<Looked> tables = looked_up(request, made);
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_EQ(tables[0].axis, (std::array<int, 2>{3, 1}));
  EXPECT_EQ(tables[0].outputs, (std::vector<int>{1, 2, 3}));
  const std::size_t y = request.machine.find_axis("Y");
  for (std::size_t k = 0; k < made.poses.count(); ++k) {
    std::vector<double> pose = made.poses.pose(k);
    pose[y] = 100;
    EXPECT_LT(off_by(request.machine, request.errors, corrected(tables, request.machine, pose), pose),
              std::sqrt(3.0) * *request.tolerance_mm);
  }
}

TEST(AerotechPlanes, LeaveOutWhatIsBelowItsUncertaintyAndNameIt) {
  ControlTableRequest request = mill_request("aerotech-2d");
  request.tolerance_mm = 1e-3;
  request.leave_out_below = 12;
  ControlTables made;
  looked_up(request, made);
  EXPECT_THAT(made.left_out, testing::Not(testing::IsEmpty()));
  for (const TableFigures& table : made.tables) EXPECT_GT(table.standard_uncertainty.value_or(0), 0) << table.name;
  for (const std::string& words : made.left_out) EXPECT_THAT(words, HasSubstr(" for "));
  EXPECT_THAT(made.left_out, testing::Contains(HasSubstr("Y, Z for Y")));
  // Most of the effect of EAY is the shift of Y at a height Z, which is in that table.
  for (const CarriedError& error : made.errors) {
    if (error.name == "EAY") {
      EXPECT_LT(error.carried(), 0.6);
    } else if (error.name == "EXX") {
      EXPECT_GT(error.carried(), 0.95);
    }
  }
}

TEST(AerotechPlanes, RefuseMachinesAndAxesThatTheyCannotTake) {
  const auto refused = [](const ControlTableRequest& request) {
    try {
      make_control_tables(request);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  ControlTableRequest request = mill_request("aerotech-2d");
  request.axes = {"X"};
  EXPECT_THAT(refused(request), HasSubstr("--axis: one axis for tables over two axes; expected two or three linear"));
  request.machine = read_machine(std::string(ABBE_SOURCE_DIR) + "/examples/machines/trunnion-mill.machine.toml");
  request.errors = {};
  request.axes = {"X", "C"};
  EXPECT_THAT(refused(request), HasSubstr("--axis C: is a rotary axis; expected two or three linear axes that move"));
  request = mill_request("aerotech-2d");
  request.names = {{"X", "AX1"}};
  EXPECT_THAT(refused(request), HasSubstr("'AX1' is not a number"));
  request = mill_request("aerotech-2d");
  request.names = {{"X", "0"}};
  EXPECT_THAT(refused(request), HasSubstr("--name X=0: axes are counted from 1"));
  request = mill_request("aerotech-2d");
  request.tolerance_rad = 1e-6;
  EXPECT_THAT(refused(request), HasSubstr("--interpolation-urad: would change nothing in tables for aerotech-2d"));
}

TEST(AerotechLines, AreLookedUpAsTheReportSaysAndHoldOnTheLinesThroughTheReference) {
  for (const ControlTableRequest& request : {mill_request("aerotech-1d"), stage_request("aerotech-1d")}) {
    ControlTables made;
    const std::vector<Looked> tables = looked_up(request, made);
    ASSERT_GE(tables.size(), request.machine.axes.size());
    for (std::size_t k = 0; k < made.poses.count(); ++k) {
      const std::vector<double> pose = made.poses.pose(k);
      EXPECT_NEAR(off_by(request.machine, request.errors, corrected(tables, request.machine, pose), pose),
                  made.after.position[k], 1e-6);
    }
    EXPECT_LT(made.after.position_statistics.mean, 0.5 * made.before.position_statistics.mean);
    if (request.machine.axes.size() < 3) continue;
    for (std::size_t moving = 0; moving < 3; ++moving) {
      std::vector<double> pose = {380, 220, -230};
      for (int k = 0; k <= 20; ++k) {
        const Axis& axis = request.machine.axes[moving];
        pose[moving] = axis.travel_min + (axis.travel_max - axis.travel_min) * k / 20;
        EXPECT_LT(off_by(request.machine, request.errors, corrected(tables, request.machine, pose), pose), 3e-4);
      }
    }
  }
}

}  // namespace
}  // namespace abbe
