#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <sstream>
#include <utility>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/text_on_disk.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/even_choice.h"
#include "abbe/report/drawings/drawn_readings.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/scans/piece_deviations.h"
#include "abbe/study/scans/scan_density.h"
#include "abbe/study/scans/streamed_deviations.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

/// The scan of the bracket many times over, so that it has some pieces.
class DeviationsInPieces : public testing::Test {
 protected:
  void SetUp() override {
    const std::string examples = ABBE_SOURCE_DIR "/examples/scan/";
    folder_ = fs::path(testing::TempDir()) / ("abbe_pieces_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    const PointCloud one = read_point_cloud(examples + "bracket-scan.csv").cloud;
    std::mt19937_64 engine(5);
    std::normal_distribution<double> shift(0, 0.02);
    constexpr Eigen::Index kCopies = 15;
    cloud_.points.resize(3, kCopies * one.size());
    for (Eigen::Index k = 0; k < kCopies; ++k) {
      const Eigen::Vector3d moved(shift(engine), shift(engine), shift(engine));
      cloud_.points.middleCols(k * one.size(), one.size()) = one.points.colwise() + moved;
    }
    request_.part = read_mesh(examples + "bracket.stl");
    request_.part_file = "bracket.stl";
    request_.transform_file = "bracket-transform.csv";
    request_.pose = read_transform_file(examples + "bracket-transform.csv");
    request_.largest_mm = 0.3;
    request_.tolerance = DeviationTolerance{-0.02, 0.03};
    request_.page = true;
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& contents) {
    request_.scan_file = (folder_ / name).string();
    std::ofstream(request_.scan_file, std::ios::binary) << contents;
  }

  static std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::string pcd() const {
    const auto n = static_cast<std::size_t>(cloud_.size()) + 2;
    std::ostringstream text;
    text << "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " << n << "\nHEIGHT 1\nPOINTS " << n
         << "\nDATA binary\n";
    std::string bytes = text.str();
    const std::vector<double> none(6, std::nan(""));
    bytes.append(reinterpret_cast<const char*>(none.data()), none.size() * sizeof(double));
    bytes.append(reinterpret_cast<const char*>(cloud_.points.data()),
                 static_cast<std::size_t>(cloud_.points.size()) * sizeof(double));
    return bytes;
  }

  static std::string bytes_of(const ScanDeviations& result) {
    std::string text = evaluation_json(result.report).dump() + result.report.page.dump();
    for (const auto& [name, contents] : deviation_files(result)) text += name + contents;
    return text;
  }
  std::string as_a_whole() const {
    ScanDeviationsRequest request = request_;
    request.scan = read_point_cloud(request.scan_file);
    return bytes_of(find_deviations(request));
  }

  fs::path folder_;
  PointCloud cloud_;
  ScanDeviationsRequest request_;
};

/// Does the work from the last block to the first, each of which goes through its bytes.
void work_backwards(const NumberedWork& work) {
  ASSERT_GT(work.blocks, 2U);
  for (std::size_t block = work.blocks; block-- > 0;) {
    work.compute(block);
    std::vector<std::byte> bytes;
    work.pack(block, bytes);
    work.unpack(block, bytes);
    work.finished(block);
    bytes.pop_back();
    EXPECT_THROW(work.unpack(block, bytes), WorkError);
  }
}

TEST_F(DeviationsInPieces, HaveTheBytesOfTheScanAsAWholeInEveryFormat) {
  std::string xyz = point_cloud_csv(cloud_);
  xyz.erase(0, xyz.find('\n') + 1);
  for (char& c : xyz) c = c == ',' ? ' ' : c;
  for (const auto& [name, contents] :
       std::vector<std::pair<std::string, std::string>>{{"scan.ply", ply_bytes({.points = cloud_.points})},
                                                        {"scan.csv", point_cloud_csv(cloud_)},
                                                        {"scan.xyz", xyz},
                                                        {"scan.pcd", pcd()}}) {
    write(name, contents);
    const std::string expected = as_a_whole();
    for (const int threads : {1, 3}) {
      request_.threads = threads;
      EXPECT_EQ(bytes_of(deviations_of_file(request_, {})), expected) << name << " " << threads;
    }
    EXPECT_EQ(bytes_of(deviations_of_file(request_, {}, {}, {.work = work_backwards})), expected) << name;
  }
}

TEST_F(DeviationsInPieces, HaveTheSameFaces) {
  write("scan.ply", ply_bytes({.points = cloud_.points}));
  request_.faces = DeviationFaces::by_edges;
  request_.crease = 30 * kDegree;
  EXPECT_EQ(bytes_of(deviations_of_file(request_, {}, {}, {.work = work_backwards})), as_a_whole());
}

TEST_F(DeviationsInPieces, HaveTheSameFilesWhereTheyAreWrittenMeanwhile) {
  write("scan.ply", ply_bytes({.points = cloud_.points}));
  request_.scan = read_point_cloud(request_.scan_file);
  const auto whole = deviation_files(find_deviations(request_));
  int number = 0;
  for (const bool is_taken : {false, true}) {
    for (const bool backwards : {false, true}) {
      const fs::path folder = folder_ / ("results" + std::to_string(++number));
      std::optional<TextOnDisk> csv;
      if (is_taken) request_.take_csv = csv.emplace(folder).taker();
      JobOptions job;
      if (backwards) job.work = work_backwards;
      const ScanDeviations result = deviations_of_file(request_, {}, {}, job);
      EXPECT_EQ(result.csv_was_taken, is_taken);
      ResultsFolder results(folder);
      write_deviation_files(result, std::move(csv), results);
      results.commit();
      ASSERT_EQ(whole.size(), 2U);
      for (const auto& [name, contents] : whole) EXPECT_EQ(read(folder / name), contents) << name;
    }
  }
}

TEST_F(DeviationsInPieces, RowsAreTakenPieceByPiece) {
  write("scan.ply", ply_bytes({.points = cloud_.points}));
  std::string taken;
  int times = 0;
  request_.take_csv = [&](const std::string& text) {
    taken += text;
    ++times;
  };
  const ScanDeviations result = deviations_of_file(request_, {}, {}, {.work = work_backwards});
  EXPECT_EQ(deviation_files(result).size(), 1U);
  EXPECT_GT(times, 3);
  request_.scan = read_point_cloud(request_.scan_file);
  EXPECT_EQ(taken, deviation_files(find_deviations(request_)).front().second);
}

TEST_F(DeviationsInPieces, RowsThatWereTakenInVainAreTakenBack) {
  // In the last piece a row is no point, and is not among those that are looked at before. A reader of whole files says
  // so. One thread: the other pieces come first.
  request_.threads = 1;
  Eigen::Matrix3Xd many(3, 4 * cloud_.size());
  many << cloud_.points, cloud_.points, cloud_.points, cloud_.points;
  write("scan.csv", point_cloud_csv({many, {}}) + "1,2,three\n1,2,3\n1,2,3\n1,2,3\n");
  std::vector<std::string> taken;
  request_.take_csv = [&](const std::string& text) { taken.push_back(text); };
  EXPECT_THROW(deviations_of_file(request_, {}), InputError);
  ASSERT_GT(taken.size(), 1U);
  EXPECT_EQ(taken.back(), "");
}

TEST_F(DeviationsInPieces, OfPointsThatAllAreTooFarAreThoseOfTheScanAsAWhole) {
  request_.largest_mm = 1e-9;
  write("scan.ply", ply_bytes({.points = cloud_.points}));
  const ScanDeviations result = deviations_of_file(request_, {});
  EXPECT_FALSE(result.has_points());
  EXPECT_EQ(bytes_of(result), as_a_whole());
}

TEST_F(DeviationsInPieces, OfALongScanThePictureHasAboutTheSameColours) {
  // More points than tell how dense they are, and than are drawn: pieces and the whole choose others.
  const Eigen::Index n = cloud_.size();
  Eigen::Matrix3Xd many(3, 4 * n);
  for (Eigen::Index k = 0; k < 4; ++k) {
    many.middleCols(k * n, n) = cloud_.points.array() + 1e-4 * static_cast<double>(k);
  }
  write("scan.ply", ply_bytes({.points = many}));
  const ScanDeviations pieces = deviations_of_file(request_, {});
  EXPECT_EQ(bytes_of(deviations_of_file(request_, {}, {}, {.work = work_backwards})), bytes_of(pieces));
  request_.scan = read_point_cloud(request_.scan_file);
  const ScanDeviations whole = find_deviations(request_);
  EXPECT_EQ(evaluation_json(pieces.report), evaluation_json(whole.report));
  EXPECT_EQ(deviation_files(pieces), deviation_files(whole));
  EXPECT_EQ(pieces.report.page.at("histograms"), whole.report.page.at("histograms"));
  const nlohmann::json& own = pieces.report.page.at("surface");
  const nlohmann::json& other = whole.report.page.at("surface");
  const double radius = own.at("averaging_radius_mm");
  EXPECT_NEAR(radius / other.at("averaging_radius_mm").get<double>(), 1, 0.2);
  for (const nlohmann::json* surface : {&own, &other}) {
    EXPECT_EQ(surface->at("points").at("measured"), 4 * n);
    EXPECT_LE(surface->at("points").at("drawn"), kPointsDrawn);
    EXPECT_GE(surface->at("points").at("drawn"), kPointsDrawn / 3);
  }
}

TEST_F(DeviationsInPieces, IfNoneOfThePointsThatAreLookedAtBeforeCountsThePageShowsThoseThatDo) {
  Eigen::Matrix3Xd far = Eigen::Matrix3Xd::Constant(3, 120000, 1000.0);
  const Eigen::Index group = 1000, other = 1 - static_cast<Eigen::Index>(chosen_of_group(1000, 2));
  far.col(2 * group + other) = Eigen::Vector3d(20, 15, 0.001);
  request_.pose = {};
  write("scan.ply", ply_bytes({.points = far}));
  const ScanDeviations result = deviations_of_file(request_, {});
  ASSERT_EQ(result.compared.counted_mm.size(), 1U);
  const nlohmann::json& surface = result.report.page.at("surface");
  EXPECT_EQ(surface.at("points").at("drawn"), 1);
  EXPECT_GT(surface.at("averaging_radius_mm"), 0.1);
}

TEST_F(DeviationsInPieces, HowDenseALongScanLiesDoesNotDependOnTheFormat) {
  Eigen::Matrix3Xd many(3, 3 * cloud_.size());
  many << cloud_.points, cloud_.points, cloud_.points;
  const auto density_of = [&](const std::string& name, const std::string& contents) {
    write(name, contents);
    const PointCloudBlocks blocks(contents, name);
    return scan_density(request_, blocks, ClosestPointFinder(request_.part.mesh, 1), {});
  };
  const ScanDensity exact = density_of("scan.ply", ply_bytes({.points = many}));
  EXPECT_EQ(exact.points, static_cast<std::size_t>(many.cols()));
  std::string xyz = point_cloud_csv({many, {}});
  xyz.erase(0, xyz.find('\n') + 1);
  std::replace(xyz.begin(), xyz.end(), ',', ' ');
  for (const auto& [name, contents] :
       {std::pair("scan.csv", point_cloud_csv({many, {}})), std::pair("scan.xyz", xyz)}) {
    const ScanDensity about = density_of(name, contents);
    EXPECT_NEAR(static_cast<double>(about.points) / static_cast<double>(many.cols()), 1, 0.02) << name;
    EXPECT_NEAR(about.radius_mm / exact.radius_mm, 1, 0.15) << name;
  }
  // Three times as many points: about a place there are as many within a smaller radius.
  const ScanDensity third = density_of("scan.ply", ply_bytes({.points = cloud_.points}));
  EXPECT_NEAR(third.radius_mm / exact.radius_mm, std::sqrt(3.0), 0.35);
}

TEST(PieceDeviations, RefuseBytesThatDoNotFitTogether) {
  const AveragedPlaces places(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d::UnitZ(), 1);
  const PieceQuestion question{.places = &places, .measured = 1};
  PieceComparison comparison(question, 1);
  SurfacePoint foot{.point = Eigen::Vector3d(1, 2, 3), .distance = 0.5, .normal = Eigen::Vector3d::UnitZ()};
  comparison.add(Eigen::Vector3d(1, 2, 3.5), std::span(&foot, 1));
  PieceDeviations piece = comparison.taken();
  EXPECT_EQ(piece.rows, "1,2,3.5,0.5\n");
  std::vector<std::byte> bytes;
  piece.pack(bytes);
  PieceDeviations same;
  same.unpack(bytes);
  EXPECT_EQ(same.colours, piece.colours);
  EXPECT_EQ(same.colours.size(), 1U);
  EXPECT_EQ(same.rows, piece.rows);
  const auto expect_refused = [](const PieceDeviations& wrong) {
    std::vector<std::byte> packed;
    wrong.pack(packed);
    PieceDeviations any;
    EXPECT_THROW(any.unpack(packed), WorkError);
  };
  PieceDeviations wrong = piece;
  wrong.drawn[0].number = 1;
  expect_refused(wrong);
  wrong = piece;
  wrong.points.push_back(0);
  expect_refused(wrong);
  wrong = piece;
  wrong.faces = {0, 0};
  expect_refused(wrong);
}

}  // namespace
}  // namespace abbe
