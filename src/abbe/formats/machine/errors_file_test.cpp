#include "abbe/formats/machine/errors_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "abbe/formats/controls/turntable_machine_for_test.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

ErrorsFile parsed_errors(const std::string& text) { return parse_errors(text, "e.toml", test::endless_turntable()); }
std::string message_of_errors(const std::string& text) {
  return message_of([&] { parsed_errors(text); });
}

void write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

/// One motion of every basis with coefficients of all magnitudes.
ErrorSet random_set(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto random = [&] { return std::ldexp(uniform(generator), -static_cast<int>(generator() % 40)); };
  ErrorSet errors;
  for (int kind = 0; kind < 7; ++kind) {
    for (std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      ErrorMotion motion;
      motion.axis = axis;
      motion.component = static_cast<Component>(generator() % 6);
      Basis& basis = motion.basis;
      basis.kind = static_cast<BasisKind>(kind);
      const bool is_table = kind >= 5;
      basis.periodic = (basis.kind == BasisKind::bspline || basis.kind == BasisKind::table_linear) && axis == 0;
      if (!is_table) basis.order = 4 + static_cast<int>(generator() % 5);
      basis.from = std::abs(random());
      basis.to = basis.from + 1 + std::abs(random());
      if (is_table) {
        basis.nodes = {basis.from, basis.from + 0.1 + 0.1 * uniform(generator), basis.to};
      }
      if (basis.periodic || basis.kind == BasisKind::fourier) basis.period = 2.5 + random();
      for (std::size_t i = 0; i < basis.size(); ++i) {
        motion.coefficients.push_back(random());
        if (axis == 1) motion.standard_uncertainty.push_back(std::abs(random()));
      }
      errors.motions.push_back(motion);
    }
  }
  for (const Component component : {Component::X, Component::Y, Component::A, Component::B, Component::C}) {
    errors.locations.push_back({0, component, random(), std::abs(random())});
  }
  errors.locations.push_back({1, Component::C, random(), 0});
  errors.reversals = {{1, random(), std::abs(random())}, {0, random(), 0}};
  errors.tool_offset_error = {random(), random(), random()};
  errors.composition = {ErrorOrder::before_motion, true};
  return errors;
}

void expect_same(const ErrorSet& a, const ErrorSet& b) {
  EXPECT_EQ(a.motions, b.motions);
  EXPECT_EQ(a.locations, b.locations);
  EXPECT_EQ(a.reversals, b.reversals);
  EXPECT_EQ(a.tool_offset_error, b.tool_offset_error);
  EXPECT_EQ(a.composition, b.composition);
}

TEST(ErrorsFile, ReadsBackTheSameBits) {
  std::mt19937_64 generator(7);
  for (int i = 0; i < 100; ++i) {
    ErrorsFile contents;
    contents.errors = random_set(generator);
    contents.provenance = {{"method", "joint \"fit\""}, {"date", "2026-01-01"}};
    if (i % 2 == 1) {
      contents.distrusted = {"the residuals are \"large\"", "EX0C is 700 mm"};
      contents.misfit_accepted = i % 4 == 1;
      contents.warnings = {"not identified: EXX"};
    }
    const ErrorsFile back = parsed_errors(errors_text(test::endless_turntable(), contents));
    expect_same(back.errors, contents.errors);
    EXPECT_EQ(back.errors.parameters(), contents.errors.parameters());
    ASSERT_EQ(back.provenance.size(), 2U);
    EXPECT_EQ(back.distrusted, contents.distrusted);
    EXPECT_EQ(back.misfit_accepted, contents.misfit_accepted);
    EXPECT_EQ(back.warnings, contents.warnings);
  }
}

TEST(ErrorsFile, CovarianceReadsBackTheSameBits) {
  std::mt19937_64 generator(8);
  std::normal_distribution<double> normal;
  ErrorsFile contents;
  contents.errors = random_set(generator);
  const auto count = static_cast<Eigen::Index>(contents.errors.parameter_count());
  Eigen::MatrixXd root(count, count);
  for (double& value : root.reshaped()) value = 1e-4 * normal(generator);
  const Eigen::MatrixXd product = root * root.transpose();
  contents.covariance = product.selfadjointView<Eigen::Lower>();
  const auto folder = test::empty_folder("abbe_covariance");
  write_errors(folder / "a.errors.toml", test::endless_turntable(), contents);
  EXPECT_TRUE(std::filesystem::exists(folder / "a.covariance.csv"));
  const ErrorsFile back = read_errors(folder / "a.errors.toml", test::endless_turntable());
  expect_same(back.errors, contents.errors);
  EXPECT_EQ(back.covariance, contents.covariance);
}

TEST(ErrorsFile, ReadsUnitsTablesAndDefaults) {
  const auto folder = test::empty_folder("abbe_tables");
  write(folder / "x.csv", "# straightness\nu_EYX_um,X_m,EYX_um\n0.5,0,1\n0.5,0.7,-2\n0.5,1.4,3\n");
  write(folder / "e.toml",
        "[[motion]]\nname=\"EYX\"\nbasis=\"table-monotone\"\ntable=\"x.csv\"\n"
        "[[motion]]\nname=\"EAC\"\nbasis=\"fourier\"\norder=1\ncoefficients_arcsec=[0, 1, 2]\n"
        "[[location]]\nname=\"EC0X\"\nvalue_urad=12.3\nstandard_uncertainty_urad=0.5\n");
  const ErrorsFile contents = read_errors(folder / "e.toml", test::endless_turntable());
  const ErrorMotion& table = contents.errors.motions[0];
  EXPECT_EQ(table.basis.nodes, (std::vector<double>{0, 700, 1400}));
  EXPECT_EQ(table.coefficients, (std::vector<double>{0.001, -0.002, 0.003}));
  EXPECT_EQ(table.standard_uncertainty, (std::vector<double>{0.0005, 0.0005, 0.0005}));
  const ErrorMotion& fourier = contents.errors.motions[1];
  EXPECT_EQ(fourier.basis.period, 2 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(fourier.coefficients[2], 2 * std::numbers::pi / 648000);
  EXPECT_EQ(contents.errors.locations[0].value, 12.3e-6);
  EXPECT_EQ(contents.covariance.size(), 0);
}

TEST(ErrorsFile, ReadsAndRefusesReversals) {
  const ErrorsFile contents = parsed_errors(
      "[[reversal]]\naxis = \"X\"\nvalue_um = -6.5\nstandard_uncertainty_um = 0.5\n"
      "[[reversal]]\naxis = \"C\"\nvalue_arcsec = -2\n");
  ASSERT_EQ(contents.errors.reversals.size(), 2U);
  EXPECT_EQ(contents.errors.reversals[0].value, -0.0065);
  EXPECT_EQ(contents.errors.reversals[0].standard_uncertainty, 0.0005);
  EXPECT_DOUBLE_EQ(contents.errors.reversals[1].value, -2 * std::numbers::pi / 648000);
  EXPECT_EQ(parsed_errors(errors_text(test::endless_turntable(), contents)).errors.reversals,
            contents.errors.reversals);
  EXPECT_THAT(message_of_errors("[[reversal]]\naxis = \"Q\"\nvalue_um = 1\n"),
              testing::HasSubstr("\"Q\" is not an axis of this machine"));
  EXPECT_THAT(message_of_errors("[[reversal]]\naxis = \"C\"\nvalue_um = 1\n"), testing::HasSubstr("value_urad"));
  EXPECT_THAT(message_of_errors("[[reversal]]\naxis = \"X\"\nvalue_um = 1\n[[reversal]]\naxis = \"X\"\nvalue_um = 1\n"),
              testing::HasSubstr("is given twice"));
}

TEST(ErrorsFile, RefusesWhatIsNoErrorOfTheMachine) {
  const std::string rest = "basis=\"legendre\"\norder=1\ncoefficients_um=[0, 1]\n";
  const std::string hint =
      "expected E, one of X Y Z A B C, and an axis of the machine (C, X, Z): EXC; location errors with 0: EA0C";
  EXPECT_EQ(message_of_errors("[[motion]]\nname=\"EXY\"\n" + rest),
            "e.toml:2:1: motion[1].name: \"EXY\" is not an error of this machine; " + hint);
  EXPECT_EQ(message_of_errors("[[motion]]\nname=\"EX0C\"\n" + rest),
            "e.toml:2:1: motion[1].name: \"EX0C\" is a location error; expected it under [[location]]");
  EXPECT_EQ(message_of_errors("[[location]]\nname=\"EZ0C\"\nvalue_um=1\n"),
            "e.toml:2:1: location[1].name: this component has no effect on the axis; expected a location error that "
            "displaces the axis line");
  EXPECT_EQ(message_of_errors("[[location]]\nname=\"EX0C\"\nvalue_um=1\n[[location]]\nname=\"EX0C\"\nvalue_um=1\n"),
            "e.toml:5:1: location[2].name: is given twice");
  EXPECT_EQ(message_of_errors("chain = \"w b X t\"\n"),
            "e.toml:1:1: chain: the errors belong to \"w b X t\"; expected \"w C' X' b Z t\"");
}

TEST(ErrorsFile, RefusesValuesThatAreTooLargeForErrors) {
  EXPECT_EQ(message_of_errors("[[location]]\nname=\"EA0C\"\nvalue_deg=-846.6\n"),
            "e.toml:3:1: location[1].value_deg: is too large for an error of a machine; expected at most 90 deg to "
            "either side");
  EXPECT_EQ(message_of_errors("[[reversal]]\naxis=\"X\"\nvalue_m=-101\n"),
            "e.toml:3:1: reversal[1].value_m: is too large for an error of a machine; expected at most 100 m to "
            "either side");
  EXPECT_EQ(message_of_errors("[[motion]]\nname=\"EXX\"\nbasis=\"legendre\"\norder=0\ncoefficients_um=[1e11]\n"),
            "e.toml:5:1: motion[1].coefficients_um: is too large for an error of a machine; expected at most 100 m to "
            "either side");
}

TEST(ErrorsFile, RefusesWrongUnitsNumbersAndBases) {
  const std::string start = "[[motion]]\nname=\"EAX\"\nbasis=\"legendre\"\norder=1\n";
  EXPECT_EQ(message_of_errors(start + "coefficients_um=[0, 1]\n"),
            "e.toml:5:1: motion[1].coefficients_um: 'um' is not a unit of an angle; expected coefficients_rad, "
            "coefficients_mrad, coefficients_urad, coefficients_deg or coefficients_arcsec");
  EXPECT_EQ(message_of_errors(start + "coefficients_urad=[0, 1, 2]\n"),
            "e.toml:5:19: motion[1].coefficients_urad: has 3 elements; expected an array of 2 numbers in urad");
  EXPECT_EQ(message_of_errors(start + "coefficients_urad=[0, nan]\n"),
            "e.toml:5:23: motion[1].coefficients_urad[2]: nan is not a finite number; expected an angle in urad");
  EXPECT_EQ(
      message_of_errors(start + "coefficients_urad=[0, 1]\nfrom_mm=5\nto_mm=5\n"),
      "e.toml:7:1: motion[1].to_mm: `to` is not above `from`; expected the range of positions in which the errors "
      "are valid");
  EXPECT_EQ(message_of_errors(start + "coefficients_urad=[0, 1]\nstandard_uncertainty_urad=[1, -1]\n"),
            "e.toml:6:1: motion[1].standard_uncertainty_urad: is negative; expected values not below zero");
  EXPECT_EQ(message_of_errors("[[motion]]\nname=\"EAX\"\nbasis=\"spline\"\n"),
            "e.toml:3:1: motion[1].basis: unknown word \"spline\"; expected \"monomial\", \"legendre\", \"chebyshev\", "
            "\"fourier\", \"bspline\", \"table-linear\" or \"table-monotone\"");
  EXPECT_EQ(message_of_errors("[[motion]]\nname=\"EAX\"\nbasis=\"fourier\"\norder=1\ncoefficients_urad=[0,0,0]\n"),
            "e.toml:1:1: motion[1].period_mm: missing; expected a length (period_mm, period_um or period_m)");
  EXPECT_EQ(message_of_errors("[[motions]]\nname=\"EAX\"\n"), "e.toml:1:3: motions: unknown key, did you mean motion?");
  EXPECT_EQ(
      message_of_errors("[[motion]]\nname=\"EXX\"\nbasis=\"table-linear\"\nat_mm=[0,2,1]\ncoefficients_um=[0,1,2]\n"),
      "e.toml:4:1: motion[1].at_mm: is not increasing");
}

TEST(ErrorsFile, RefusesCovariancesThatDoNotFit) {
  const auto folder = test::empty_folder("abbe_bad_covariance");
  write(folder / "e.toml", "covariance=\"c.csv\"\n[[location]]\nname=\"EC0X\"\nvalue_urad=1\n");
  const std::string file = (folder / "c.csv").string();
  const auto with = [&](const std::string& text) {
    write(folder / "c.csv", text);
    return message_of([&] { read_errors(folder / "e.toml", test::endless_turntable()); });
  };
  const std::string header = "parameter,unit,EC0X,tool_X,tool_Y,tool_Z\n";
  EXPECT_EQ(with("parameter,unit,EB0X,tool_X,tool_Y,tool_Z\n"),
            file + ":1: EB0X: is not the parameter of the errors file at this place; expected EC0X");
  EXPECT_EQ(with(header + "EC0X,um,1,0,0,0\n"), file + ":2: EC0X: unit 'um'; expected urad");
  EXPECT_EQ(with(header + "EC0X,urad,1,0,0,x\n"),
            file + ":2: tool_Z: 'x' is not a finite number; expected a covariance in urad um");
  const auto pair = [&](const std::string& above, const std::string& below, const std::string& variance = "4") {
    return header + "EC0X,urad,1," + above + ",0,0\ntool_X,um," + below + "," + variance +
           ",0,0\ntool_Y,um,0,0,1,0\ntool_Z,um,0,0,0,0\n";
  };
  EXPECT_EQ(with(pair("1", "1.00000001")), file +
                                               ":3: EC0X: is not symmetric; expected a covariance matrix, symmetric "
                                               "to 1e-10 in its correlations");
  EXPECT_EQ(with(pair("1", "1", "-4")), file + ":3: tool_X: the variance is negative; expected a covariance matrix");
  const std::string indefinite =
      file +
      ": covariance: covariance is not positive semi-definite; expected a covariance matrix: no variance below zero "
      "in any direction";
  EXPECT_EQ(with(pair("1e-3", "1e-3", "0")), indefinite);  // of a parameter that is known exactly
  EXPECT_EQ(with(header + "EC0X,urad,1,0,0,0\n"),
            file + ":2: tool_X: the row has 0 fields; expected 6 as in the header");
  // A correlation of 2 between the tool's offsets in X and Y; one of 1 is one.
  const auto tool = [&](const std::string& xy) {
    return header + "EC0X,urad,1,0,0,0\ntool_X,um,0,1," + xy + ",0\ntool_Y,um,0," + xy + ",1,0\ntool_Z,um,0,0,0,0\n";
  };
  EXPECT_EQ(with(tool("2")), indefinite);
  write(folder / "c.csv", tool("1"));
  EXPECT_EQ(read_errors(folder / "e.toml", test::endless_turntable()).covariance(1, 2), 1e-6);
  // Other programs write the two entries of a pair with different last digits.
  write(folder / "c.csv", pair("1", "1.0000000000000002"));
  const Eigen::MatrixXd found = read_errors(folder / "e.toml", test::endless_turntable()).covariance;
  EXPECT_EQ(found(0, 1), found(1, 0));
  EXPECT_NEAR(found(0, 1), 1e-9, 1e-24);
}

}  // namespace
}  // namespace abbe
