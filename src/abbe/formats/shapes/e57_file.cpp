#include "abbe/formats/shapes/e57_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "abbe/formats/shapes/e57_pages.h"
#include "abbe/formats/shapes/e57_scans.h"
#include "abbe/formats/shapes/e57_section.h"
#include "abbe/formats/shapes/e57_xml.h"
#include "abbe/formats/shapes/found_points.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/instruments/trackers/tracker.h"

namespace abbe {
namespace {

class E57PointReader {
 public:
  E57PointReader(const E57Pages& pages, const std::vector<E57Scan>& scans, const std::string& file)
      : scans_(scans), file_(file) {
    for (const E57Scan& scan : scans) {
      E57Section& section = sections_.emplace_back(pages, scan, file);
      require_own_bytes(section, scan);
      section.find_packets();
      require_bits(pages, scan);
      points_ += scan.points;
      has_normals_ = has_normals_ || scan.has_normals();
    }
  }

  void read(PointCloudFile& result) const {
    FoundPoints found(static_cast<Eigen::Index>(points_), has_normals_);
    Eigen::Index first = 0;
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      read_scan(scans_[i], sections_[i], first, found);
      first += static_cast<Eigen::Index>(scans_[i].points);
    }
    found.finish(file_, result);
  }

 private:
  /// Sections that several scans share would take more time and memory than the file has bytes for.
  void require_own_bytes(const E57Section& section, const E57Scan& scan) {
    const auto place = taken_.insert(section.extent()).first;
    const bool is_alone = (place == taken_.begin() || std::prev(place)->second <= place->first) &&
                          (std::next(place) == taken_.end() || std::next(place)->first >= place->second);
    if (is_alone && taken_.size() == sections_.size()) return;
    throw InputError({.file = file_, .field = scan.name + " points"},
                     fmt::format("at byte {}: the section overlaps that of another scan", scan.section),
                     "a section of its own");
  }

  /// Where all fields are constants, no byte tells how many points there are: all together at most one for each bit.
  void require_bits(const E57Pages& pages, const E57Scan& scan) const {
    if (points_ <= 8 * pages.size() && scan.points <= 8 * pages.size() - points_) return;
    throw InputError({.file = file_, .field = scan.name + " recordCount"},
                     fmt::format("{} points are stated, all of which are the same", scan.points), "points that differ");
  }

  void read_scan(const E57Scan& scan, const E57Section& section, Eigen::Index first, FoundPoints& found) const {
    const auto count = static_cast<Eigen::Index>(scan.points);
    const bool normals = scan.has_normals(), states = scan.wanted[kE57Invalid] != E57Scan::kNone;
    std::vector<double> state(states ? scan.points : 0);
    std::array<E57Section::Target, kE57WantedCount> targets;
    for (Eigen::Index k = 0; k < 3; ++k) {
      targets[kE57Point + static_cast<std::size_t>(k)] = {&found.points()(k, first), 3};
      if (normals) targets[kE57Normal + static_cast<std::size_t>(k)] = {&found.normals()(k, first), 3};
    }
    if (states) targets[kE57Invalid] = {state.data(), 1};
    section.read(targets);
    for (Eigen::Index i = 0; i < count; ++i) {
      if (states && state[static_cast<std::size_t>(i)] != 0) {
        found.leave_out_invalid();
        continue;
      }
      Eigen::Vector3d point = found.points().col(first + i);
      if (!point.allFinite()) {
        found.leave_out_not_finite();
        continue;
      }
      // Azimuth from x towards y, elevation from the xy plane: ASTM E2807-11, 6.7.
      if (scan.is_spherical) point = point_from_range_and_angles(point);
      point = millimetres(FileLength::metre) * (scan.file_from_scan * point);
      for (int k = 0; k < 3; ++k) {
        if (!(std::abs(point[k]) <= kLargestInput)) refuse_large(scan, i, point[k], "xyz"[k]);
      }
      if (!has_normals_) {
        found.keep(point);
      } else if (normals) {
        found.keep(point, scan.file_from_scan.rotation * found.normals().col(first + i));
      } else {
        found.keep(point, Eigen::Vector3d::Zero());
      }
    }
  }

  [[noreturn]] void refuse_large(const E57Scan& scan, Eigen::Index point, double value_mm, char axis) const {
    throw InputError({.file = file_, .field = fmt::format("{} {}", scan.name, axis)},
                     fmt::format("point {}: {:g} mm is too large", point, value_mm),
                     fmt::format("at most {:g} mm", kLargestInput));
  }

  const std::vector<E57Scan>& scans_;
  const std::string& file_;
  std::vector<E57Section> sections_;
  std::set<std::pair<std::uint64_t, std::uint64_t>> taken_;  ///< extents of the sections
  std::uint64_t points_ = 0;
  bool has_normals_ = false;
};

}  // namespace

bool is_e57(std::string_view contents) { return contents.starts_with("ASTM-E57"); }

PointCloudFile parse_e57(std::string_view contents, const std::string& file, const std::optional<FileLength>& unit,
                         int threads) {
  PointCloudFile result;
  result.unit = agreed_unit(FileLength::metre, unit, file);
  const E57Pages pages(contents, file, threads);
  const std::vector<E57Scan> scans = e57_scans(parse_e57_xml(pages.xml(), file), file);
  result.format = scans.size() == 1 ? "E57, 1 scan" : fmt::format("E57, {} scans", scans.size());
  E57PointReader(pages, scans, file).read(result);
  return result;
}

}  // namespace abbe
