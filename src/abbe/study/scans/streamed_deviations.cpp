#include "abbe/study/scans/streamed_deviations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "abbe/formats/files/file_stamp.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/point_cloud_blocks.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/evaluations/deviation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/scans/closest_points.h"
#include "abbe/study/scans/deviation_steps.h"
#include "abbe/study/scans/scan_of_part.h"
#include "abbe/study/scans/scan_pieces.h"
#include "abbe/verify/parts/deviation_sums.h"

namespace abbe {
namespace {

/// The sums of one scan, which are made in pieces.
class StreamJob {
 public:
  StreamJob(const ScanDeviationsRequest& request, const PointCloudOptions& scan, const StreamingOptions& options,
            const JobOptions& job)
      : request_(request),
        scan_(scan),
        options_(options),
        job_(job),
        stamp_(file_stamp(request.scan_file)),
        file_(request.scan_file),
        blocks_(file_.text(), request.scan_file, scan),
        pieces_(blocks_, options.block),
        surface_(request.part.mesh, request.threads),
        faces_(faces_of_part(request)),
        statistics_{request.tolerance, request.largest_mm, faces_.face_of_triangle, faces_.count()},
        sums_(statistics_, options.shown),
        states_(pieces_.count()),
        places_(pieces_.count()) {}

  /// @returns whether all sums are here: of several processes, the first one has them
  bool read() {
    NumberedWork work{.name = "comparison of the scan", .blocks = pieces_.count(), .threads = request_.threads};
    // The points of a piece have all threads.
    work.in_parallel = false;
    work.fingerprint = [this] { return fingerprint(); };
    work.compute = [this](std::size_t piece) { compare(piece); };
    work.pack = [this](std::size_t piece, std::vector<std::byte>& bytes) {
      const auto state = std::as_bytes(std::span(states_[piece]));
      bytes.insert(bytes.end(), state.begin(), state.end());
    };
    work.unpack = [this](std::size_t piece, std::span<const std::byte> bytes) {
      states_[piece].assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    work.finished = [this](std::size_t piece) {
      read_bytes_ += pieces_.end(piece) - pieces_.begin(piece);
      if (job_.progress) job_.progress(read_bytes_, blocks_.end() - blocks_.begin());
    };
    work.reduce = [this](std::size_t piece) { reduce(piece); };
    do_work(job_.work, work);
    require_unchanged(blocks_.end(), sums_.points() + not_finite_);
    if (reduced_ < pieces_.count()) return false;
    require_places();
    if (sums_.points() > 0) return true;
    throw InputError({.file = request_.scan_file},
                     not_finite_ > 0 ? fmt::format("none of the {} points has coordinates", not_finite_)
                                     : std::string("there is no point"),
                     "the points of a scan");
  }

  ScanDeviations result();

 private:
  /// What stands in front of the state of a piece.
  struct Place {
    std::uint64_t first = 0, points = 0, not_finite = 0;
  };

  /// Of everything on which the sums depend.
  std::uint64_t fingerprint() const {
    const RigidTransform& pose = request_.pose.transform;
    Digest digest;
    digest.add_text("deviations 1");
    digest.add_text(vector_instructions());
    for (const std::int64_t number : {stamp_.seconds, stamp_.nanoseconds})
      digest.add(static_cast<std::uint64_t>(number));
    for (const std::uint64_t number : {stamp_.bytes, fingerprint_of_mesh(request_.part.mesh),
                                       std::uint64_t{pieces_.points_of_piece()}, std::uint64_t{options_.shown}}) {
      digest.add(number);
    }
    for (const double value : pose.rotation.reshaped()) digest.add_number(value);
    for (const double value : pose.translation) digest.add_number(value);
    digest.add_text(deviation_options_text(request_, scan_));
    return digest.value();
  }

  void require_unchanged(std::size_t at, std::uint64_t point) const {
    if (file_stamp(request_.scan_file) == stamp_) return;
    throw InputError({.file = request_.scan_file},
                     fmt::format("was changed while it was read, at byte {}, behind point {}", at, point),
                     "a file that does not change meanwhile");
  }

  void compare(std::size_t piece) {
    Place place{.first = pieces_.first_point(piece, request_.threads)};
    DeviationSums own(statistics_, options_.shown);
    const RigidTransform& pose = request_.pose.transform;
    for (std::size_t at = pieces_.begin(piece); at < pieces_.end(piece);) {
      stop_if_asked(job_.stop);
      require_unchanged(at, place.first + own.points());
      const std::size_t end = std::min(blocks_.block_end(at, options_.block), pieces_.end(piece));
      const CloudBlock block = blocks_.read(at, end, request_.threads);
      const Eigen::Matrix3Xd points = (pose.rotation * block.points).colwise() + pose.translation;
      if (points.cols() > 0) {
        own.add(place.first + own.points(), points, surface_.closest(points, request_.threads, job_.stop),
                request_.threads);
      }
      place.not_finite += block.not_finite;
      at = end;
      file_.forget(end);
    }
    place.points = own.points();
    pieces_.set_points(piece, place.points);
    const std::lock_guard lock(mutex_);
    states_[piece].assign(reinterpret_cast<const char*>(&place), sizeof place);
    states_[piece] += own.state(sums_.sample());
  }

  void reduce(std::size_t piece) {
    const std::string state = std::exchange(states_[piece], {});
    Place& place = places_[piece];
    if (state.size() < sizeof place) throw WorkError("the sums of a piece of the scan are cut off");
    std::memcpy(&place, state.data(), sizeof place);
    pieces_.set_points(piece, place.points);
    const std::lock_guard lock(mutex_);
    try {
      sums_.add_state(std::string_view(state).substr(sizeof place));
    } catch (const std::invalid_argument& error) {
      throw WorkError(error.what());
    }
    not_finite_ += place.not_finite;
    ++reduced_;
  }

  /// The points of a piece have the right numbers only if those of all pieces in front were counted right.
  void require_places() const {
    std::uint64_t next = 0;
    for (const Place& place : places_) {
      if (place.first != next) throw WorkError("the points of the scan were counted in two ways");
      next += place.points;
    }
  }

  const ScanDeviationsRequest& request_;
  const PointCloudOptions& scan_;
  const StreamingOptions& options_;
  const JobOptions& job_;
  FileStamp stamp_;
  MappedFile file_;
  PointCloudBlocks blocks_;
  ScanPieces pieces_;
  ClosestPointFinder surface_;
  SurfaceFaces faces_;
  SurfaceDeviationOptions statistics_;
  std::mutex mutex_;  // of the sums: a piece is compared while others are added
  DeviationSums sums_;
  std::vector<std::string> states_;  // of pieces that were not added yet
  std::vector<Place> places_;
  std::uint64_t not_finite_ = 0;
  std::size_t read_bytes_ = 0, reduced_ = 0;
};

/// The points that are shown, on the part.
ScanComparison shown_comparison(const ClosestPointFinder& surface, const std::vector<SampledPoint>& shown,
                                int threads) {
  ScanComparison result;
  result.counted_points.resize(3, static_cast<Eigen::Index>(shown.size()));
  for (std::size_t i = 0; i < shown.size(); ++i) {
    result.counted_points.col(static_cast<Eigen::Index>(i)) = shown[i].point;
    result.counted_mm.push_back(shown[i].deviation_mm);
  }
  result.closest = surface.closest(result.counted_points, threads);
  return result;
}

ScanDeviations StreamJob::result() {
  ScanDeviations result;
  const std::vector<SampledPoint> shown = sums_.sample().points();
  result.compared = shown_comparison(surface_, shown, request_.threads);
  const SurfaceDeviation of_shown = surface_deviation(result.compared.closest);
  result.compared.deviation.all = sums_.all();
  result.compared.deviation.regions = sums_.regions();
  result.compared.deviation.beyond_border = sums_.beyond_border();
  result.compared.deviation.too_far = sums_.too_far();
  result.compared.faces = faces_;
  PointCloudFile scan;
  scan.format = blocks_.format();
  scan.unit = blocks_.unit();
  scan.left_out = not_finite_;
  note_left_out(scan);
  const FineHistogram& histogram = sums_.histogram();
  result.colour_mm =
      request_.colour_mm > 0 ? request_.colour_mm : colour_range_of_amount(histogram.percentile_of_amounts(0.98).value);
  result.report = deviation_report(asked_of_report(request_),
                                   StreamedScan{.file = &scan,
                                                .points = sums_.points(),
                                                .histogram = &histogram,
                                                .shown = shown.size(),
                                                .least = sums_.sample().least(),
                                                .largest = sums_.sample().largest()},
                                   request_.part, result.compared, result.colour_mm);
  if (result.has_points()) {
    note_scan_elsewhere(request_.part, histogram.percentile_of_amounts(0.5).value, result);
  }
  apply_tolerances(request_.tolerances, result.report);
  if (request_.page) {
    stop_if_asked(job_.stop);
    result.report.page =
        deviation_page(request_.part.mesh, result.compared.closest, of_shown, result.colour_mm, request_.threads);
    state_all_points(sums_.points(), result.compared.deviation.all.sample.count, histogram, result.colour_mm,
                     result.report.page);
  }
  return result;
}

}  // namespace

bool is_read_in_blocks(const std::string& scan_file, std::uint64_t above) {
  const MappedFile file(scan_file);
  const std::uint64_t bytes = file.text().size();
  // Fewer bytes than a point can have.
  if (bytes <= above) return false;
  const PointCloudKind kind = point_cloud_kind(file.text(), scan_file);
  if (kind.points) return *kind.points > above;
  if (bytes / kBytesOfPointInText <= above) return false;
  if (kind.in_blocks) return true;
  throw InputError({.file = scan_file},
                   fmt::format("{} bytes are too many for a file of this kind, which is read as a whole", bytes),
                   fmt::format("binary PLY, binary PCD, CSV or XYZ, which are read in blocks; or --stream-above with "
                               "more than {}, if there is memory",
                               bytes / kBytesOfPointInText));
}

ScanDeviations deviations_of_file(ScanDeviationsRequest request, const PointCloudOptions& scan,
                                  const StreamingOptions& options, const JobOptions& job) {
  if (!is_read_in_blocks(request.scan_file, options.above)) {
    if (std::optional<ScanDeviations> found = deviations_in_pieces(request, scan, job)) return std::move(*found);
    request.scan = read_point_cloud(request.scan_file, scan);
    return find_deviations(request, job);
  }
  check_deviation_request(request);
  if (request.part.mesh.size() == 0) {
    throw InputError({.file = request.part_file}, "there is no triangle", "the surface of a part");
  }
  StreamJob stream(request, scan, options, job);
  return stream.read() ? stream.result() : ScanDeviations();
}

}  // namespace abbe
