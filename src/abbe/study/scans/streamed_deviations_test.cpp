#include "abbe/study/scans/streamed_deviations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "abbe/formats/files/work_checkpoint.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/report/words/evaluation_text.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class StreamedDeviations : public testing::Test {
 protected:
  void SetUp() override {
    const std::string examples = ABBE_SOURCE_DIR "/examples/scan/";
    folder_ = fs::path(testing::TempDir()) / ("abbe_streamed_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    cloud_ = read_point_cloud(examples + "bracket-scan.csv").cloud;
    request_.part_file = "bracket.stl";
    request_.transform_file = "bracket-transform.csv";
    request_.part = read_mesh(examples + "bracket.stl");
    request_.pose = read_transform_file(examples + "bracket-transform.csv");
    request_.largest_mm = 0.3;
    request_.tolerance = DeviationTolerance{-0.02, 0.03};
    request_.faces = DeviationFaces::by_edges;
    request_.crease = 30 * kDegree;
    request_.page = true;
    options_.above = 100;
    options_.block = 300;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& contents) const {
    std::ofstream(folder_ / name, std::ios::binary) << contents;
    return (folder_ / name).string();
  }
  std::string ply() const { return write("scan.ply", ply_bytes({.points = cloud_.points})); }
  std::string xyz() const {
    std::string text = point_cloud_csv(cloud_);
    text.erase(0, text.find('\n') + 1);
    for (char& c : text) c = c == ',' ? ' ' : c;
    return write("scan.xyz", text);
  }
  std::string pcd(std::size_t without_coordinates) const {
    const auto n = static_cast<std::size_t>(cloud_.size()) + without_coordinates;
    std::ostringstream text;
    text << "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " << n << "\nHEIGHT 1\nPOINTS " << n
         << "\nDATA binary\n";
    std::string bytes = text.str();
    const std::vector<double> none(3 * without_coordinates, std::nan(""));
    bytes.append(reinterpret_cast<const char*>(none.data()), none.size() * sizeof(double));
    bytes.append(reinterpret_cast<const char*>(cloud_.points.data()),
                 static_cast<std::size_t>(cloud_.points.size()) * sizeof(double));
    return write("scan.pcd", bytes);
  }

  ScanDeviations in_blocks(const std::string& file, const JobOptions& job = {}) {
    request_.scan_file = file;
    return deviations_of_file(request_, {}, options_, job);
  }
  ScanDeviations as_a_whole(const std::string& file) {
    request_.scan_file = file;
    request_.scan = read_point_cloud(file);
    return find_deviations(request_);
  }
  static JobOptions kept_in(WorkCheckpoint& checkpoint) {
    JobOptions job;
    job.work = [&](const NumberedWork& work) { checkpoint.work(work, {}); };
    return job;
  }
  static std::string bytes_of(const ScanDeviations& result) {
    std::string text = evaluation_json(result.report).dump() + result.report.page.dump();
    for (const auto& [name, contents] : deviation_files(result)) text += name + contents;
    return text;
  }

  fs::path folder_;
  PointCloud cloud_;
  ScanDeviationsRequest request_;
  StreamingOptions options_;
};

TEST_F(StreamedDeviations, AreThoseOfTheScanInMemoryInEveryFormat) {
  for (const std::string& file : {ply(), xyz(), write("scan.csv", point_cloud_csv(cloud_)), pcd(3)}) {
    const ScanDeviations all = as_a_whole(file), streamed = in_blocks(file);
    ASSERT_TRUE(is_read_in_blocks(file, options_.above)) << file;
    const DeviationStatistics &a = all.compared.deviation.all, &b = streamed.compared.deviation.all;
    EXPECT_EQ(a.sample.count, b.sample.count) << file;
    EXPECT_EQ(all.compared.deviation.too_far, streamed.compared.deviation.too_far);
    EXPECT_NEAR(a.sample.mean, b.sample.mean, 1e-15);
    EXPECT_NEAR(a.sample.deviation, b.sample.deviation, 1e-15);
    EXPECT_NEAR(a.sample.rms, b.sample.rms, 1e-15);
    EXPECT_NEAR(a.rms_about_mean, b.rms_about_mean, 1e-15);
    EXPECT_EQ(a.sample.minimum, b.sample.minimum);
    EXPECT_EQ(a.sample.maximum, b.sample.maximum);
    EXPECT_EQ(a.within, b.within);
    const auto& bounds = streamed.report.details["percentile_error_at_most_um"];
    const auto near = [&](double x, double y, const char* name) {
      const double bound = 1e-3 * bounds.at(name).get<double>();
      EXPECT_LE(std::abs(x - y), bound * (1 + 1e-9)) << name;
      EXPECT_LT(bound, std::max(1e-8, 1e-4 * std::abs(x))) << name;
    };
    near(a.p5, b.p5, "p5");
    near(a.p25, b.p25, "p25");
    near(a.sample.median, b.sample.median, "median");
    near(a.p75, b.p75, "p75");
    near(a.sample.p95, b.sample.p95, "p95");
    ASSERT_EQ(all.compared.deviation.regions.size(), streamed.compared.deviation.regions.size());
    for (std::size_t i = 0; i < all.compared.deviation.regions.size(); ++i) {
      const SampleStatistics &c = all.compared.deviation.regions[i].sample,
                             &d = streamed.compared.deviation.regions[i].sample;
      EXPECT_EQ(c.count, d.count);
      EXPECT_NEAR(c.mean, d.mean, 1e-15);
      EXPECT_NEAR(c.deviation, d.deviation, 1e-15);
    }
    // All points are fewer than are shown.
    EXPECT_EQ(all.compared.counted_mm, streamed.compared.counted_mm);
    EXPECT_EQ(all.colour_mm, streamed.colour_mm);
  }
}

TEST_F(StreamedDeviations, WithoutAPageTheReportOfAScanInMemoryHasTheSameBytesInEveryFormat) {
  for (const std::string& file : {ply(), xyz(), write("scan.csv", point_cloud_csv(cloud_)), pcd(3)}) {
    request_.page = false;
    const ScanDeviations all = as_a_whole(file);
    options_.above = kStreamedAbove;
    const std::string expected = evaluation_json(all.report).dump();
    for (const int threads : {1, 2}) {
      request_.threads = threads;
      const ScanDeviations found = in_blocks(file);
      EXPECT_EQ(evaluation_json(found.report).dump(), expected) << file;
      EXPECT_EQ(found.colour_mm, all.colour_mm);
      EXPECT_EQ(found.elsewhere, all.elsewhere);
      EXPECT_EQ(found.compared.counted_mm, all.compared.counted_mm);
    }
    // Another process packs its pieces, and the first one takes them.
    std::vector<std::vector<std::byte>> pieces;
    std::vector<std::uint64_t> fingerprints;
    JobOptions job;
    job.work = [&](const NumberedWork& work) {
      pieces.assign(work.blocks, {});
      fingerprints.push_back(work.fingerprint());
      for (std::size_t piece = 0; piece < work.blocks; ++piece) {
        work.compute(piece);
        work.pack(piece, pieces[piece]);
      }
    };
    EXPECT_FALSE(in_blocks(file, job).has_points()) << "the first process alone has the result";
    const WorkDriver computing = job.work;
    job.work = [&](const NumberedWork& work) {
      for (std::size_t piece = work.blocks; piece-- > 0;) {
        work.unpack(piece, pieces[piece]);
        work.finished(piece);
      }
    };
    EXPECT_EQ(evaluation_json(in_blocks(file, job).report).dump(), expected) << file;
    request_.largest_mm *= 2;
    job.work = computing;
    in_blocks(file, job);
    request_.largest_mm /= 2;
    ASSERT_EQ(fingerprints.size(), 2U);
    EXPECT_NE(fingerprints[0], fingerprints[1]) << "it depends on what was asked for";
  }
}

TEST_F(StreamedDeviations, HaveTheSameBytesForAllThreadsAndBlocks) {
  const std::string file = xyz();
  options_.shown = 150;
  const std::string expected = bytes_of(in_blocks(file));
  EXPECT_LT(in_blocks(file).compared.counted_mm.size(), 400U);
  for (const std::size_t block : {std::size_t{1}, std::size_t{77}, std::size_t{100000}}) {
    options_.block = block;
    for (const int threads : {1, 2}) {
      request_.threads = threads;
      EXPECT_EQ(bytes_of(in_blocks(file)), expected) << block << " " << threads;
    }
  }
}

TEST_F(StreamedDeviations, GoOnAfterAKillWithTheSameBytes) {
  const std::string file = ply();
  options_.shown = 150;
  options_.block = 7;
  const std::string expected = bytes_of(in_blocks(file));
  request_.threads = 1;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    WorkCheckpoint checkpoint(folder_ / "out", {.after_s = 0, .remaining_s = 0});
    JobOptions job = kept_in(checkpoint);
    job.progress = [](std::size_t done, std::size_t total) {
      if (done > total / 2) ::kill(::getpid(), SIGKILL);
    };
    in_blocks(file, job);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  std::string told;
  const auto tell = [&](const std::string& sentence) { told += sentence; };
  WorkCheckpoint checkpoint(folder_ / "out", {.after_s = 0, .remaining_s = 0, .tell = tell});
  ASSERT_GT(fs::file_size(checkpoint.path()), 100U);
  EXPECT_EQ(bytes_of(in_blocks(file, kept_in(checkpoint))), expected);
  EXPECT_THAT(told, HasSubstr("blocks of the comparison of the scan are taken from"));
  checkpoint.remove();
  EXPECT_FALSE(fs::exists(checkpoint.path()));
}

TEST_F(StreamedDeviations, DoNotUseSumsOfOtherOptionsOrFiles) {
  const std::string file = ply();
  std::vector<std::uint64_t> fingerprints;
  JobOptions job;
  job.work = [&](const NumberedWork& work) {
    fingerprints.push_back(work.fingerprint());
    work_in_threads(work);
  };
  in_blocks(file, job);
  request_.largest_mm = 0.2;
  in_blocks(file, job);
  request_.pose.transform.translation.x() += 1e-6;
  in_blocks(file, job);
  request_.part.mesh.vertices(0, 0) += 1e-6;
  in_blocks(file, job);
  fs::last_write_time(file, fs::last_write_time(file) + std::chrono::seconds(1));
  in_blocks(file, job);
  options_.shown = 10;
  in_blocks(file, job);
  std::sort(fingerprints.begin(), fingerprints.end());
  EXPECT_EQ(std::unique(fingerprints.begin(), fingerprints.end()), fingerprints.end());
  EXPECT_EQ(fingerprints.size(), 6U);
}

// What another process leaves out of its pieces has been pushed out by pieces that it has sent before.
TEST_F(StreamedDeviations, OfSeveralProcessesHaveTheSameBytes) {
  options_.shown = 150;
  options_.block = 7;
  for (const std::string& file : {ply(), xyz(), pcd(3)}) {
    const std::string expected = bytes_of(in_blocks(file));
    std::vector<std::pair<std::size_t, std::vector<std::byte>>> sent;
    JobOptions other;
    other.work = [&](const NumberedWork& work) {
      for (std::size_t piece = 1; piece < work.blocks; piece += piece % 3) {
        work.compute(piece);
        work.pack(piece, sent.emplace_back(piece, std::vector<std::byte>()).second);
        work.reduce(piece);
      }
    };
    EXPECT_FALSE(in_blocks(file, other).has_points()) << "a process without all sums has a result";
    std::size_t bytes = 0;
    JobOptions first;
    first.work = [&](const NumberedWork& work) {
      NumberedWork rest = work;
      rest.is_there.assign(work.blocks, 0);
      for (const auto& [piece, results] : sent) {
        work.unpack(piece, results);
        work.reduce(piece);
        rest.is_there[piece] = 1;
        bytes += results.size();
      }
      work_in_threads(rest);
    };
    EXPECT_EQ(bytes_of(in_blocks(file, first)), expected) << file;
    EXPECT_GT(bytes, 1000U);
  }
}

TEST_F(StreamedDeviations, StopBetweenBlocks) {
  std::stop_source source;
  JobOptions job;
  job.stop = source.get_token();
  job.progress = [&](std::size_t, std::size_t) { source.request_stop(); };
  EXPECT_THROW(in_blocks(ply(), job), Stopped);
}

TEST_F(StreamedDeviations, SayWhatIsWrongWithTheFile) {
  const std::string file = ply();
  JobOptions job;
  job.progress = [&](std::size_t, std::size_t) { std::ofstream(file, std::ios::app) << "more"; };
  EXPECT_THAT(message_of([&] { in_blocks(file, job); }), HasSubstr("was changed while it was read"));
  const std::string whole = ply_bytes({.points = cloud_.points});
  const std::string cut = write("cut.ply", whole.substr(0, whole.size() - 5));
  EXPECT_THAT(message_of([&] { in_blocks(cut); }), HasSubstr("are stated, but only"));
  PointCloud broken = cloud_;
  broken.points(1, 7) = std::nan("");
  const std::string nan = write("nan.ply", ply_bytes({.points = broken.points}));
  EXPECT_THAT(message_of([&] { in_blocks(nan); }), HasSubstr("vertex 7: not a finite number"));
  const std::string text = write("bad.xyz", "1 2 3\n4 5 6\n7 x 9\n" + std::string(6000, '\n'));
  EXPECT_THAT(message_of([&] { in_blocks(text); }), HasSubstr("bad.xyz:3:3: y: 'x' is not a number"));
  options_.above = 0;
  const std::string empty = write("empty.csv", "x_mm,y_mm,z_mm\n");
  EXPECT_THAT(message_of([&] { in_blocks(empty); }), HasSubstr("there are no rows below the header"));
  const std::string ascii = write("ascii.ply",
                                  "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                  "property float y\nproperty float z\nend_header\n1 2 3\n");
  EXPECT_THAT(message_of([&] { in_blocks(ascii); }), HasSubstr("which is read as a whole"));
}

}  // namespace
}  // namespace abbe
