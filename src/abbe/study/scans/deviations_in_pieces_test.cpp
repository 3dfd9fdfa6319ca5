#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "abbe/formats/shapes/ply_file.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/scans/piece_deviations.h"
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
    constexpr Eigen::Index kCopies = 20;
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

TEST_F(DeviationsInPieces, HaveTheSameFacesAndFilesThatAreTaken) {
  write("scan.ply", ply_bytes({.points = cloud_.points}));
  request_.faces = DeviationFaces::by_edges;
  request_.crease = 30 * kDegree;
  ScanDeviations result = deviations_of_file(request_, {}, {}, {.work = work_backwards});
  EXPECT_EQ(bytes_of(result), as_a_whole());
  const auto copied = deviation_files(result);
  EXPECT_EQ(taken_deviation_files(result), copied);
}

TEST_F(DeviationsInPieces, HaveTheSameRowsWhereTheyAreTakenMeanwhile) {
  write("scan.ply", ply_bytes({.points = cloud_.points}));
  std::string taken;
  int times = 0;
  request_.take_csv = [&](const std::string& text) {
    taken += text;
    ++times;
  };
  for (const bool backwards : {false, true}) {
    taken.clear();
    JobOptions job;
    if (backwards) job.work = work_backwards;
    ScanDeviations result = deviations_of_file(request_, {}, {}, job);
    EXPECT_TRUE(result.csv_was_taken);
    const auto files = taken_deviation_files(result);
    ASSERT_EQ(files.size(), 1U);
    request_.scan = read_point_cloud(request_.scan_file);
    const auto all = deviation_files(find_deviations(request_));
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(taken, all[0].second);
    EXPECT_EQ(files[0], all[1]);
  }
  EXPECT_GT(times, 10);
}

TEST_F(DeviationsInPieces, RowsThatWereTakenInVainAreTakenBack) {
  // The last piece is no table of points; a reader of whole files says so. One thread: the other pieces come first.
  request_.threads = 1;
  write("scan.csv", point_cloud_csv(cloud_) + "1,2,three\n");
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

TEST(PieceDeviations, RefuseBytesThatDoNotFitTogether) {
  PieceDeviations piece;
  SurfacePoint foot{.point = Eigen::Vector3d(1, 2, 3), .distance = 0.5, .normal = Eigen::Vector3d::UnitZ()};
  piece.add(Eigen::Vector3d(1, 2, 3.5), std::span(&foot, 1), {.with_points = true});
  EXPECT_EQ(piece.rows, "1,2,3.5,0.5\n");
  std::vector<std::byte> bytes;
  piece.pack(bytes);
  PieceDeviations same;
  same.unpack(bytes);
  EXPECT_EQ(same.feet, piece.feet);
  EXPECT_EQ(same.rows, piece.rows);
  piece.normal_of[0] = 1;
  bytes.clear();
  piece.pack(bytes);
  EXPECT_THROW(same.unpack(bytes), WorkError);
  piece.normal_of = {0, 0};
  bytes.clear();
  piece.pack(bytes);
  EXPECT_THROW(same.unpack(bytes), WorkError);
}

}  // namespace
}  // namespace abbe
