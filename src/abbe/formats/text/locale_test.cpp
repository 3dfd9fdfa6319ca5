// Files are the same in every locale: reading and writing with a decimal comma set, for the standard library and for C.
#include <gtest/gtest.h>

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <locale>
#include <string>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/json_text.h"

namespace abbe {
namespace {

class DecimalComma : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// Everything that is written about one machine, its errors and readings.
std::string written() {
  const Machine machine = parse_machine(
      "name = \"m\"\nchain = \"w C' b X t\"\n[axis.C]\ntravel_deg = [-90.5, 90.5]\n[axis.X]\ntravel_mm = [0.5, "
      "12345.25]\n",
      "m.toml");
  ErrorsFile errors = parse_errors(
      "[[motion]]\nname = \"EXX\"\nbasis = \"legendre\"\norder = 1\ncoefficients_um = [1.5, 1234567.25e-3]\n", "e.toml",
      machine);
  errors.covariance = Eigen::MatrixXd::Identity(5, 5) * 1.5e-6;
  const MeasurementTable table = parse_measurements(
      "X_mm,C_deg,measured_x_mm,measured_y_mm,measured_z_mm\n1234.5,1.5,1e3,0.25,3\n", "r.csv", machine);
  return machine_text(machine) + errors_text(machine, errors) + covariance_text(machine, errors) +
         measurements_text(machine, table) + commented_machine_file("w C b X t") +
         json_text({{"a", 1234.5}, {"b", 1000000}});
}

/// Compiles a locale of its own with a decimal comma, so that the test does not depend on what is installed, and sets
/// it.
bool set_decimal_comma() {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "abbe_locale";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::ofstream source(folder / "comma.src");
  source << "escape_char /\nLC_NUMERIC\ndecimal_point \",\"\nthousands_sep \".\"\ngrouping 3;3\nEND LC_NUMERIC\n";
  for (const char* category : {"LC_CTYPE", "LC_COLLATE", "LC_MONETARY", "LC_TIME", "LC_MESSAGES"}) {
    source << category << "\ncopy \"POSIX\"\nEND " << category << "\n";
  }
  source.close();
  const std::string command = "cd '" + folder.string() +
                              "' && localedef -c --no-archive -i ./comma.src -f ANSI_X3.4-1968 ./comma "
                              ">/dev/null 2>&1";
  static_cast<void>(std::system(command.c_str()));  // missing categories are a warning with an exit code
  ::setenv("LOCPATH", folder.c_str(), 1);
  if (std::setlocale(LC_ALL, "comma") != nullptr) return true;
  ::unsetenv("LOCPATH");
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) return true;
  }
  return false;
}

class Locale : public testing::Test {
 protected:
  void TearDown() override {
    std::locale::global(std::locale::classic());
    std::setlocale(LC_ALL, "C");
    ::unsetenv("LOCPATH");
  }
};

TEST_F(Locale, DecimalCommaOfTheStandardLibraryChangesNothing) {
  const std::string expected = written();
  std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  ASSERT_EQ(std::use_facet<std::numpunct<char>>(std::locale()).decimal_point(), ',');
  EXPECT_EQ(written(), expected);
}

TEST_F(Locale, DecimalCommaOfTheSystemChangesNothing) {
  const std::string expected = written();
  if (!set_decimal_comma()) GTEST_SKIP() << "no locale with a decimal comma and no localedef to make one";
  char text[8];
  std::snprintf(text, sizeof text, "%.1f", 1.5);
  ASSERT_STREQ(text, "1,5") << "else the test shows nothing";
  EXPECT_EQ(written(), expected);
}

}  // namespace
}  // namespace abbe
