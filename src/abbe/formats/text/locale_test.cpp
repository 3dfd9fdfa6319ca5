// Files are the same in every locale: reading and writing with a decimal comma set, for the standard library and for C.
#include <gtest/gtest.h>

#include <clocale>
#include <cstdio>
#include <locale>
#include <string>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/decimal_comma_for_test.h"
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

class Locale : public testing::Test {
 protected:
  void TearDown() override {
    std::locale::global(std::locale::classic());
    test::unset_decimal_comma();
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
  if (!test::set_decimal_comma()) GTEST_SKIP() << "no locale with a decimal comma and no localedef to make one";
  char text[8];
  std::snprintf(text, sizeof text, "%.1f", 1.5);
  ASSERT_STREQ(text, "1,5") << "else the test shows nothing";
  EXPECT_EQ(written(), expected);
}

}  // namespace
}  // namespace abbe
