#include "abbe/formats/readings/scan_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/fixed_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

Machine machine() {
  return parse_machine(
      "name = \"m\"\nchain = \"w C' X' b Z t\"\n[axis.C]\nendless = true\n[axis.X]\ntravel_mm = [-50, 50]\n"
      "[axis.Z]\ntravel_mm = [0, 60]\n[tool]\nreference_mm = [0, 0, 20]\n",
      "m");
}

/// Errors of Z known from 0 to 40 mm only.
ErrorSet errors_of(const Machine& machine) {
  ErrorSet errors;
  errors.locations.push_back({machine.find_axis("C"), Component::X, 0.3, 0});
  ErrorMotion motion;
  motion.axis = machine.find_axis("Z");
  motion.component = Component::X;
  motion.basis = {.kind = BasisKind::legendre, .order = 1, .from = 0, .to = 40};
  motion.coefficients = {0.001, 0.01};
  errors.motions.push_back(motion);
  return errors;
}

std::string many_readings(std::size_t rows) {
  std::string text = "# a scan\nC_deg,X_mm,Z_mm,indication_um\n";
  for (std::size_t k = 0; k < rows; ++k) {
    RandomStream random(11, k);
    text += fmt::format("{:.6f},{:.6f},{:.6f},{:.3f}\n", random.uniform(-720, 720), random.uniform(-50, 50),
                        random.uniform(0, 45), random.uniform(-250, 250));
  }
  return text;
}

TEST(ScanFile, GivesThePointsOfTheWholeReadingsWhateverTheRunsAndThreads) {
  const Machine m = machine();
  const ErrorSet errors = errors_of(m);
  const PointScan scan(m, errors, {});
  constexpr std::size_t kRows = 60000;  // three runs of a mebibyte
  const std::string text = many_readings(kRows);
  ASSERT_GT(text.size(), std::size_t{2} << 20);
  ScanOptions options;
  options.lowest_indication = -0.2;
  options.highest_indication = 0.2;
  // The same at once, with the readers and the kernel that the runs use in pieces.
  const CsvTable table = read_csv(
      text, "all",
      {{"C", Quantity::angle}, {"X", Quantity::length}, {"Z", Quantity::length}, {"indication", Quantity::length}});
  std::vector<double> x(kRows), y(kRows), z(kRows);
  std::vector<std::uint8_t> covered(kRows, 1);
  const double* axis[] = {table.columns[0].numbers.data(), table.columns[1].numbers.data(),
                          table.columns[2].numbers.data()};
  const std::vector<double>& h = table.columns[3].numbers;
  scan.points({axis, kRows}, h.data(), {x.data(), y.data(), z.data()}, covered.data());
  std::string expected = "x_mm,y_mm,z_mm\n";
  ScanSummary sum;
  for (std::size_t k = 0; k < kRows; ++k) {
    const bool seen = h[k] >= -0.2 && h[k] <= 0.2;
    sum.out_of_range += seen ? 0U : 1U;
    sum.not_covered += seen && covered[k] == 0 ? 1U : 0U;
    if (!seen || covered[k] == 0) continue;
    expected += fmt::format("{:.9f},{:.9f},{:.9f}\n", x[k], y[k], z[k]);
    ++sum.points;
  }
  EXPECT_GT(sum.out_of_range, 1000U);
  EXPECT_GT(sum.not_covered, 1000U);
  for (const int threads : {1, 3}) {
    options.threads = threads;
    std::string written;
    const ScanSummary summary = scan_points(text, "readings.csv", m, scan, ScanFormat::csv, options,
                                            [&](std::string_view piece) { written += piece; });
    EXPECT_EQ(summary.readings, kRows);
    EXPECT_EQ(summary.points, sum.points);
    EXPECT_EQ(summary.out_of_range, sum.out_of_range);
    EXPECT_EQ(summary.not_covered, sum.not_covered);
    EXPECT_TRUE(written == expected) << threads;
  }
}

TEST(ScanFile, WritesPlyThatReadsBackToTheSameBits) {
  const Machine m = machine();
  const PointScan scan(m, {}, {});
  const auto folder = std::filesystem::path(testing::TempDir()) / "abbe_scan_file";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "r.csv") << "Z_mm,h,C_deg,X_mm,note\n30,100,0,10,a\n10,-50,90,20,b\n40,900,0,0,c\n";
  ScanOptions options;
  options.mapping.columns = {{"indication_um", "h"}};
  options.mapping.ignore = {"note"};
  options.highest_indication = 0.2;
  const ScanSummary summary = scan_points(folder / "r.csv", m, scan, folder / "p.ply", options);
  EXPECT_EQ(summary.points, 2U);
  EXPECT_EQ(summary.out_of_range, 1U);
  const PointCloudFile cloud = read_point_cloud(folder / "p.ply");
  ASSERT_EQ(cloud.cloud.size(), 2);
  EXPECT_EQ(cloud.unit.source, UnitSource::stated);
  // X' carries the workpiece: the tool moves along +x in it; the beam looks along -z.
  EXPECT_LT((cloud.cloud.points.col(0) - Eigen::Vector3d(10, 0, 20 + 30 - 0.1)).norm(), 1e-12);
  EXPECT_LT((cloud.cloud.points.col(1) - Eigen::Vector3d(0, 20, 20 + 10 + 0.05)).norm(), 1e-12);
  EXPECT_LT((summary.lowest - Eigen::Vector3d(0, 0, 30.05)).norm(), 1e-12);
  EXPECT_LT((summary.highest - Eigen::Vector3d(10, 20, 49.9)).norm(), 1e-12);
  EXPECT_EQ(scan_ply_header(0).size(), scan_ply_header(12345678901).size());
}

TEST(ScanFile, NamesLineAndFieldOfWhatIsWrong) {
  const Machine m = machine();
  const PointScan scan(m, {}, {});
  const auto message = [&](const std::string& text) {
    return message_of([&] { scan_points(text, "r.csv", m, scan, ScanFormat::csv, {}, [](std::string_view) {}); });
  };
  const std::string header = "C_deg,X_mm,Z_mm,indication_mm\n";
  EXPECT_NE(message(header + "0,0,0,0\n\n0,60,0,0\n").find("r.csv:4"), std::string::npos)
      << message(header + "0,60,0,0\n");
  EXPECT_NE(message(header + "0,60,0,0\n").find("outside the travel of axis X"), std::string::npos);
  EXPECT_NE(message(header + "0,0,0,nan\n").find("not a finite number"), std::string::npos);
  EXPECT_NE(message(header + "0,0,0\n").find("3 fields"), std::string::npos) << message(header + "0,0,0\n");
  EXPECT_NE(message(header + "0,0,0,0\n0,0,0,1e12\n").find("r.csv:3"), std::string::npos);
  EXPECT_NE(message(header).find("no rows"), std::string::npos);
  EXPECT_NE(message("C_deg,X_mm,Z_mm\n0,0,0\n").find("indication_mm"), std::string::npos);
  EXPECT_THROW(scan_format("points.xyz"), InputError);
}

TEST(FixedText, RoundsAsPrintfDoes) {
  const auto text = [](double value, int decimals) {
    char buffer[kLongestFixedText];
    return std::string(buffer, write_fixed(value, decimals, buffer));
  };
  EXPECT_EQ(text(0, 9), "0.000000000");
  EXPECT_EQ(text(-1e-12, 9), "0.000000000");
  EXPECT_EQ(text(-12.5, 0), "-13");
  EXPECT_EQ(text(1e12, 12), "1000000000000.000000000000");
  for (std::size_t k = 0; k < 2000; ++k) {
    RandomStream random(5, k);
    const double value = random.uniform(-1000, 1000) * std::pow(10.0, std::floor(random.uniform(-6, 3)));
    for (const int decimals : {0, 3, 9}) {
      std::string expected = fmt::format("{:.{}f}", value, decimals);
      // A zero has no sign here.
      if (expected.find_first_of("123456789") == std::string::npos && expected[0] == '-') expected.erase(0, 1);
      EXPECT_EQ(text(value, decimals), expected);
    }
  }
}

TEST(StreamedFile, AppearsWholeOrNotAtAll) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "abbe_streamed_file";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto files = [&] {
    return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
  };
  {
    StreamedFile file(folder / "a.txt");
    file.append("0000 first");
    file.overwrite(0, "1234");
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    file.commit();
  }
  EXPECT_EQ(read_text_file(folder / "a.txt"), "1234 first");
  {
    StreamedFile file(folder / "a.txt");
    file.append("never committed");
  }
  EXPECT_EQ(read_text_file(folder / "a.txt"), "1234 first");
  {
    StreamedFile file(folder / "a.txt");
    file.append("second");
    file.commit();
  }
  EXPECT_EQ(read_text_file(folder / "a.txt"), "second");
  EXPECT_EQ(files(), 1);
  EXPECT_THROW(StreamedFile{folder}, InputError);
  EXPECT_THROW(StreamedFile{folder / "missing" / "b.txt"}, InputError);
}

}  // namespace
}  // namespace abbe
