#include "abbe/study/scans/scan_registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

ScanRegistrationRequest scan_and_part(const std::string& name) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/scan/";
  ScanRegistrationRequest request;
  request.scan_file = "scans/" + name + "-scan.csv";
  request.part_file = "parts/" + name + ".stl";
  request.scan = read_point_cloud(examples + name + "-scan.csv");
  request.part = read_mesh(examples + name + ".stl");
  return request;
}

TEST(ScanRegistrationOfARequest, LaysTheScanOnItsPart) {
  ScanRegistrationRequest request = scan_and_part("bracket");
  request.compare = true;
  const ScanRegistration result = register_scan(std::move(request));
  ASSERT_TRUE(result.is_ok());
  ASSERT_TRUE(result.compared);
  EXPECT_EQ(result.compared->closest.size(), static_cast<std::size_t>(result.scan.cloud.size()));
  // The scan that lies on its part stays there.
  ScanRegistrationRequest again = scan_and_part("bracket");
  again.scan.cloud = registered_scan(result);
  const ScanRegistration stays = register_scan(std::move(again));
  ASSERT_TRUE(stays.is_ok());
  EXPECT_LT(stays.found.fine.mesh_from_scan.translation.norm(), 1e-3);
  EXPECT_FALSE(stays.compared);
  EXPECT_THAT(scan_registration_text(result),
              testing::StartsWith("Registration of scans/bracket-scan.csv on parts/bracket.stl\n  scan: "));
  EXPECT_EQ(scan_registration_json(result)["status"], "ok");
  EXPECT_THAT(scan_registration_page(result), HasSubstr("Registration of bracket-scan.csv on bracket.stl"));
  std::map<std::string, std::string> files;
  for (const auto& [name, contents] : scan_registration_files(result)) files[name] = contents;
  EXPECT_EQ(files.size(), 4U);
  EXPECT_THAT(files["transform.csv"], testing::Not(HasSubstr("status")));
  EXPECT_TRUE(files.contains("registered.ply"));
}

TEST(ScanRegistrationOfARequest, APoseThatIsOneOfManySaysSo) {
  const ScanRegistration result = register_scan(scan_and_part("pin"));
  EXPECT_FALSE(result.is_ok());
  std::map<std::string, std::string> files;
  for (const auto& [name, contents] : scan_registration_files(result)) files[name] = contents;
  EXPECT_THAT(files["transform.csv"], testing::StartsWith("# status: "));
}

TEST(ScanRegistrationOfARequest, TellsHowFarItIsAndStops) {
  std::stop_source source;
  std::size_t last = 0;
  const auto progress = [&](std::size_t done, std::size_t total) {
    EXPECT_GE(done, last);
    EXPECT_LE(done, total);
    last = done;
    source.request_stop();
  };
  EXPECT_THROW(register_scan(scan_and_part("bracket"), {.progress = progress, .stop = source.get_token()}), Stopped);
  EXPECT_GT(last, 0U);
  EXPECT_THROW(register_scan(scan_and_part("bracket"), {.stop = source.get_token()}), Stopped);
}

TEST(ScanRegistrationOfARequest, NothingIsNotRegistered) {
  ScanRegistrationRequest empty = scan_and_part("pin");
  empty.scan.cloud = {};
  EXPECT_THAT(message_of([&] { register_scan(empty); }), HasSubstr("scans/pin-scan.csv: there is no point"));
  empty = scan_and_part("pin");
  empty.part.mesh = {};
  EXPECT_THAT(message_of([&] { register_scan(empty); }), HasSubstr("parts/pin.stl: there is no triangle"));
}

}  // namespace
}  // namespace abbe
