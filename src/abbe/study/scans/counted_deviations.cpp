#include "abbe/study/scans/counted_deviations.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>

#include "abbe/formats/files/file_stamp.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/deviation_rows.h"
#include "abbe/formats/shapes/point_cloud_blocks.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/bounding_box.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/study/scans/closest_points.h"
#include "abbe/study/scans/deviation_steps.h"
#include "abbe/study/scans/piece_deviations.h"
#include "abbe/study/scans/scan_density.h"
#include "abbe/study/scans/scan_pieces.h"

namespace abbe {
namespace {

/// Points that are read and searched together: they stay in the cache of a processor.
constexpr std::size_t kPointsTogether = 8192;
constexpr double kRadiusOfFew = 0.01;  // of the diagonal of the part

/// A matrix of three rows that grows by columns. The expected number of columns is only an estimate.
class GrowingColumns {
 public:
  explicit GrowingColumns(Eigen::Index about) : columns_(3, about) {}

  /// Room for so many more.
  double* grow(std::size_t count) {
    const Eigen::Index before = size_;
    size_ += static_cast<Eigen::Index>(count);
    if (size_ > columns_.cols()) columns_.conservativeResize(3, std::max(size_, 2 * columns_.cols()));
    return columns_.data() + 3 * before;
  }

  Eigen::Matrix3Xd taken() {
    if (size_ < columns_.cols()) columns_.conservativeResize(3, size_);
    return std::move(columns_);
  }

 private:
  Eigen::Matrix3Xd columns_;
  Eigen::Index size_ = 0;
};

/// One scan, whose pieces are read and compared in any order and put together in theirs.
class CountedJob {
 public:
  CountedJob(const ScanDeviationsRequest& request, const PointCloudOptions& scan, const ClosestPointFinder& surface,
             const SurfaceFaces& faces, const JobOptions& job)
      : request_(request),
        scan_(scan),
        surface_(surface),
        question_{.largest_mm = request.largest_mm, .face_of_triangle = faces.face_of_triangle},
        job_(job),
        stamp_(file_stamp(request.scan_file)),
        file_(request.scan_file),
        blocks_(file_.text(), request.scan_file, scan),
        pieces_(blocks_, kPointsTogether),
        found_(pieces_.count()),
        is_there_(pieces_.count()),
        points_(request.page ? static_cast<Eigen::Index>(blocks_.about_points()) : 0) {
    result_.all.reserve(blocks_.about_points());
    result_.faces.resize(faces.count());
  }

  std::optional<CountedDeviations> run() {
    // Every process finds out by the first points that a table has another form.
    if (pieces_.count() > 0) blocks_.read(blocks_.begin(), blocks_.block_end(blocks_.begin(), 1), 1);
    if (request_.page) prepare_picture();
    NumberedWork work{.name = "comparison of the scan", .blocks = pieces_.count(), .threads = request_.threads};
    work.is_kept = false;
    work.fingerprint = [this] { return fingerprint(); };
    work.compute = [this](std::size_t piece) { compare(piece); };
    work.pack = [this](std::size_t piece, std::vector<std::byte>& bytes) { found_[piece].pack(bytes); };
    work.unpack = [this](std::size_t piece, std::span<const std::byte> bytes) { found_[piece].unpack(bytes); };
    work.finished = [this](std::size_t piece) { note(piece); };
    do_work(job_.work, work);
    if (!(file_stamp(request_.scan_file) == stamp_)) {
      throw InputError({.file = request_.scan_file}, "was changed while it was read", "a file that nobody changes");
    }
    if (added_ < found_.size()) return std::nullopt;
    describe_scan();
    result_.points_mm = points_.taken();
    return std::move(result_);
  }

 private:
  void prepare_picture() {
    const ScanDensity density = scan_density(request_, blocks_, surface_, job_.stop);
    // If none of these points counts, only a few of all do.
    const double dense = density.radius_mm > 0
                             ? density.radius_mm
                             : kRadiusOfFew * bounding_box(request_.part.mesh.vertices).diagonal().norm();
    result_.part = coloured_part(request_.part.mesh, dense, request_.threads);
    result_.colours = PlaceSums(result_.part.places.count());
    result_.drawn.emplace(density.points);
    question_.places = &result_.part.places;
    question_.measured = density.points;
  }

  std::uint64_t fingerprint() const {
    const RigidTransform& pose = request_.pose.transform;
    Digest digest;
    digest.add_text(request_.page ? "deviations that count, with a picture" : "deviations that count");
    digest.add_text(vector_instructions());
    digest.add(digest_of_many(std::as_bytes(std::span(file_.text()))));
    digest.add(fingerprint_of_mesh(request_.part.mesh));
    digest.add_numbers({pose.rotation.data(), 9});
    digest.add_numbers({pose.translation.data(), 3});
    digest.add_text(deviation_options_text(request_, scan_));
    return digest.value();
  }

  void compare(std::size_t piece) {
    const RigidTransform& pose = request_.pose.transform;
    PieceComparison own(question_, pieces_.points_of_piece());
    for (std::size_t at = pieces_.begin(piece); at < pieces_.end(piece);) {
      const std::size_t end = std::min(blocks_.block_end(at, kPointsTogether), pieces_.end(piece));
      const CloudBlock block = blocks_.read(at, end, 1);
      const Eigen::Matrix3Xd points = (pose.rotation * block.points).colwise() + pose.translation;
      own.add_not_finite(block.not_finite);
      if (points.cols() > 0) own.add(points, surface_.closest(points, 1, job_.stop));
      at = end;
    }
    found_[piece] = own.taken();
  }

  /// Puts the pieces together as they come: while others are still compared, that takes no time of its own.
  void note(std::size_t piece) {
    is_there_[piece] = 1;
    for (; added_ < found_.size() && is_there_[added_] != 0; ++added_) {
      PieceDeviations own = std::exchange(found_[added_], {});
      result_.points += own.counts[0];
      result_.scan.left_out += own.counts[1];
      result_.beyond_border += own.counts[2];
      result_.too_far += own.counts[3];
      if (question_.places != nullptr) {
        add_to_picture(own);
        std::copy(own.points.begin(), own.points.end(), points_.grow(own.deviation_mm.size()));
        add_rows(std::move(own.rows), own.deviation_mm.size());
      }
      result_.all.insert(result_.all.end(), own.deviation_mm.begin(), own.deviation_mm.end());
      for (std::size_t i = 0; i < own.faces.size(); ++i) result_.faces[own.faces[i]].push_back(own.deviation_mm[i]);
    }
    read_bytes_ += pieces_.end(piece) - pieces_.begin(piece);
    if (job_.progress) job_.progress(read_bytes_, blocks_.end() - blocks_.begin());
  }

  void add_to_picture(const PieceDeviations& own) {
    result_.drawn->append(own.drawn, result_.all.size());
    try {
      result_.colours.add(own.colours);
    } catch (const std::invalid_argument& error) {
      throw WorkError(error.what());
    }
  }

  void add_rows(std::string rows, std::size_t n) {
    if (rows.empty()) return;
    if (request_.take_csv) {
      if (!has_rows_) request_.take_csv(std::string(kDeviationCsvHeader));
      request_.take_csv(std::move(rows));
    } else {
      // Reserved from the first piece, since the others have about as much text; otherwise the text would be copied
      // each time it doubles.
      if (!has_rows_) {
        result_.csv.reserve(rows.size() / n * blocks_.about_points() / 16 * 17);
        result_.csv = kDeviationCsvHeader;
      }
      result_.csv += rows;
    }
    has_rows_ = true;
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
  PieceQuestion question_;
  const JobOptions& job_;
  FileStamp stamp_;
  MappedFile file_;
  PointCloudBlocks blocks_;
  ScanPieces pieces_;
  std::vector<PieceDeviations> found_;  // of pieces that were not added yet
  std::vector<std::uint8_t> is_there_;
  CountedDeviations result_;
  GrowingColumns points_;
  std::size_t added_ = 0, read_bytes_ = 0;
  bool has_rows_ = false;
};

}  // namespace

std::optional<CountedDeviations> counted_deviations(const ScanDeviationsRequest& request, const PointCloudOptions& scan,
                                                    const ClosestPointFinder& surface, const SurfaceFaces& faces,
                                                    const JobOptions& job) {
  return CountedJob(request, scan, surface, faces, job).run();
}

}  // namespace abbe
