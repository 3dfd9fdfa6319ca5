#include "abbe/study/scans/counted_deviations.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "abbe/formats/files/file_stamp.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/point_cloud_blocks.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/study/scans/closest_points.h"
#include "abbe/study/scans/deviation_steps.h"
#include "abbe/study/scans/scan_pieces.h"

namespace abbe {
namespace {

/// Points that are read and searched together: they stay in the cache of a processor.
constexpr std::size_t kPointsTogether = 8192;

/// Of one piece of the scan.
struct PieceDeviations {
  std::array<std::uint64_t, 4> counts{};  ///< points, not finite, beyond the border, too far
  std::vector<double> counted;
  std::vector<std::uint32_t> faces;  ///< [counted], or empty

  void pack(std::vector<std::byte>& bytes) const {
    const std::uint64_t size = counted.size();
    const std::array<std::span<const std::byte>, 4> parts{
        std::as_bytes(std::span(counts)), std::as_bytes(std::span(&size, 1)), std::as_bytes(std::span(counted)),
        std::as_bytes(std::span(faces))};
    for (const std::span<const std::byte> part : parts) bytes.insert(bytes.end(), part.begin(), part.end());
  }

  void unpack(std::span<const std::byte> bytes, bool with_faces) {
    std::uint64_t size = 0;
    const auto take = [&bytes](std::span<std::byte> into) {
      if (bytes.size() < into.size()) throw WorkError("deviations of a piece of the scan are cut off");
      std::copy_n(bytes.begin(), into.size(), into.begin());
      bytes = bytes.subspan(into.size());
    };
    take(std::as_writable_bytes(std::span(counts)));
    take(std::as_writable_bytes(std::span(&size, 1)));
    if (size > bytes.size() / sizeof(double)) throw WorkError("deviations of a piece of the scan are cut off");
    counted.resize(size);
    take(std::as_writable_bytes(std::span(counted)));
    faces.resize(with_faces ? size : 0);
    take(std::as_writable_bytes(std::span(faces)));
    require_unpacked(bytes);
  }
};

/// Fingerprint of the contents of a file, some words at a time.
std::uint64_t fingerprint_of_text(std::string_view text) {
  constexpr std::size_t kWords = 8;
  std::array<Digest, kWords> digests;
  std::array<std::uint64_t, kWords> words{};
  std::size_t at = 0;
  for (; at + sizeof words <= text.size(); at += sizeof words) {
    std::memcpy(words.data(), text.data() + at, sizeof words);
    for (std::size_t k = 0; k < kWords; ++k) digests[k].add(words[k]);
  }
  Digest all;
  for (const Digest& digest : digests) all.add(digest.value());
  all.add_text(text.substr(at));
  return all.value();
}

/// One scan, whose pieces are read and compared in any order and put together in theirs.
class CountedJob {
 public:
  CountedJob(const ScanDeviationsRequest& request, const PointCloudOptions& scan, const ClosestPointFinder& surface,
             const SurfaceFaces& faces, const JobOptions& job)
      : request_(request),
        scan_(scan),
        surface_(surface),
        faces_(faces),
        job_(job),
        stamp_(file_stamp(request.scan_file)),
        file_(request.scan_file),
        blocks_(file_.text(), request.scan_file, scan),
        pieces_(blocks_, kPointsTogether),
        found_(pieces_.count()),
        is_there_(pieces_.count()) {
    result_.all.reserve(blocks_.about_points());
    result_.faces.resize(faces.count());
  }

  std::optional<CountedDeviations> run() {
    // Every process finds out by the first points that a table has another form.
    if (pieces_.count() > 0) blocks_.read(blocks_.begin(), blocks_.block_end(blocks_.begin(), 1), 1);
    NumberedWork work{.name = "comparison of the scan", .blocks = pieces_.count(), .threads = request_.threads};
    work.is_kept = false;
    work.fingerprint = [this] { return fingerprint(); };
    work.compute = [this](std::size_t piece) { compare(piece); };
    work.pack = [this](std::size_t piece, std::vector<std::byte>& bytes) { found_[piece].pack(bytes); };
    work.unpack = [this](std::size_t piece, std::span<const std::byte> bytes) {
      found_[piece].unpack(bytes, faces_.count() > 0);
    };
    work.finished = [this](std::size_t piece) { note(piece); };
    do_work(job_.work, work);
    if (!(file_stamp(request_.scan_file) == stamp_)) {
      throw InputError({.file = request_.scan_file}, "was changed while it was read", "a file that nobody changes");
    }
    if (added_ < found_.size()) return std::nullopt;
    describe_scan();
    return std::move(result_);
  }

 private:
  std::uint64_t fingerprint() const {
    const RigidTransform& pose = request_.pose.transform;
    Digest digest;
    digest.add_text("deviations that count");
    digest.add_text(vector_instructions());
    digest.add(fingerprint_of_text(file_.text()));
    digest.add(fingerprint_of_mesh(request_.part.mesh));
    digest.add_numbers({pose.rotation.data(), 9});
    digest.add_numbers({pose.translation.data(), 3});
    digest.add_text(deviation_options_text(request_, scan_));
    return digest.value();
  }

  void compare(std::size_t piece) {
    PieceDeviations& own = found_[piece];
    const RigidTransform& pose = request_.pose.transform;
    for (std::size_t at = pieces_.begin(piece); at < pieces_.end(piece);) {
      const std::size_t end = std::min(blocks_.block_end(at, kPointsTogether), pieces_.end(piece));
      const CloudBlock block = blocks_.read(at, end, 1);
      const Eigen::Matrix3Xd points = (pose.rotation * block.points).colwise() + pose.translation;
      own.counts[0] += static_cast<std::uint64_t>(points.cols());
      own.counts[1] += block.not_finite;
      if (points.cols() > 0) {
        for (const SurfacePoint& point : surface_.closest(points, 1, job_.stop)) add(point, own);
      }
      at = end;
    }
  }

  void add(const SurfacePoint& point, PieceDeviations& own) const {
    const bool far = request_.largest_mm > 0 && !(std::abs(point.distance) <= request_.largest_mm);
    if (point.on_border || far) {
      ++own.counts[point.on_border ? 2 : 3];
      return;
    }
    own.counted.push_back(point.distance);
    if (faces_.count() > 0) own.faces.push_back(faces_.face_of_triangle[point.triangle]);
  }

  /// Puts the pieces together as they come: while others are still compared, that takes no time of its own.
  void note(std::size_t piece) {
    is_there_[piece] = 1;
    for (; added_ < found_.size() && is_there_[added_] != 0; ++added_) {
      const PieceDeviations own = std::exchange(found_[added_], {});
      result_.points += own.counts[0];
      result_.scan.left_out += own.counts[1];
      result_.beyond_border += own.counts[2];
      result_.too_far += own.counts[3];
      result_.all.insert(result_.all.end(), own.counted.begin(), own.counted.end());
      for (std::size_t i = 0; i < own.faces.size(); ++i) result_.faces[own.faces[i]].push_back(own.counted[i]);
    }
    read_bytes_ += pieces_.end(piece) - pieces_.begin(piece);
    if (job_.progress) job_.progress(read_bytes_, blocks_.end() - blocks_.begin());
  }

  void describe_scan() {
    PointCloudFile& scan = result_.scan;
    scan.format = blocks_.format();
    scan.unit = blocks_.unit();
    note_left_out(scan);
    if (result_.points > 0) return;
    throw InputError({.file = request_.scan_file}, "there is no point", "the points of a scan");
  }

  const ScanDeviationsRequest& request_;
  const PointCloudOptions& scan_;
  const ClosestPointFinder& surface_;
  const SurfaceFaces& faces_;
  const JobOptions& job_;
  FileStamp stamp_;
  MappedFile file_;
  PointCloudBlocks blocks_;
  ScanPieces pieces_;
  std::vector<PieceDeviations> found_;  // of pieces that were not added yet
  std::vector<std::uint8_t> is_there_;
  CountedDeviations result_;
  std::size_t added_ = 0, read_bytes_ = 0;
};

}  // namespace

std::optional<CountedDeviations> counted_deviations(const ScanDeviationsRequest& request, const PointCloudOptions& scan,
                                                    const ClosestPointFinder& surface, const SurfaceFaces& faces,
                                                    const JobOptions& job) {
  return CountedJob(request, scan, surface, faces, job).run();
}

}  // namespace abbe
