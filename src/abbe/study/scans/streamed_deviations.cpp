#include "abbe/study/scans/streamed_deviations.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "abbe/formats/files/checkpoint.h"
#include "abbe/formats/files/file_stamp.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/shapes/point_cloud_blocks.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/digest.h"
#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/evaluations/deviation_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/scans/deviation_steps.h"
#include "abbe/study/scans/scan_of_part.h"
#include "abbe/verify/parts/deviation_sums.h"

namespace abbe {
namespace {

/// Number that differs where the surfaces differ.
std::uint64_t mark_of_mesh(const TriangleMesh& mesh) {
  Digest digest;
  for (const double value : mesh.vertices.reshaped()) digest.add_number(value);
  for (const std::uint32_t vertex : mesh.triangles.reshaped()) digest.add(vertex);
  return digest.value();
}

std::string options_text(const ScanDeviationsRequest& request, const PointCloudOptions& scan) {
  std::string text =
      fmt::format("largest {} mm, faces {} {}", request.largest_mm, static_cast<int>(request.faces), request.crease);
  if (request.tolerance) {
    text += fmt::format(", band {} to {} mm", request.tolerance->lower_mm, request.tolerance->upper_mm);
  }
  if (scan.unit) text += fmt::format(", unit {}", file_length_name(*scan.unit));
  for (const auto& [own, theirs] : scan.mapping.columns) text += fmt::format(", column {}={}", own, theirs);
  for (const std::string& ignored : scan.mapping.ignore) text += ", ignored " + ignored;
  // A name of a column is free text.
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Everything on which the sums depend.
CheckpointFacts facts_of_job(const ScanDeviationsRequest& request, const PointCloudOptions& scan,
                             const StreamingOptions& options, const FileStamp& stamp) {
  const RigidTransform& pose = request.pose.transform;
  return {{"job", "deviate 1"},
          {"scan", fmt::format("{} bytes, changed {}.{:09}", stamp.bytes, stamp.seconds, stamp.nanoseconds)},
          {"part", fmt::format("{} triangles, {:016x}", request.part.mesh.size(), mark_of_mesh(request.part.mesh))},
          {"transform",
           fmt::format("{} {}", fmt::join(pose.rotation.reshaped(), " "), fmt::join(pose.translation.reshaped(), " "))},
          {"options", options_text(request, scan)},
          {"shown", fmt::format("{}", options.shown)}};
}

/// The reading of one scan, block by block.
class StreamJob {
 public:
  StreamJob(const ScanDeviationsRequest& request, const PointCloudOptions& scan, const StreamingOptions& options,
            const JobOptions& job)
      : request_(request),
        options_(options),
        job_(job),
        stamp_(file_stamp(request.scan_file)),
        file_(request.scan_file),
        blocks_(file_.text(), request.scan_file, scan),
        surface_(request.part.mesh, request.threads),
        faces_(faces_of_part(request)),
        statistics_{request.tolerance, request.largest_mm, faces_.face_of_triangle, faces_.count()},
        sums_(statistics_, options.shown),
        at_(blocks_.begin()) {
    if (options.output.empty()) return;
    unfinished_ = std::make_shared<Checkpoint>(options.output, facts_of_job(request, scan, options, stamp_));
    if (!unfinished_->found().empty()) go_on();
  }

  void read() {
    using Clock = std::chrono::steady_clock;
    const std::size_t from = at_;
    auto saved = Clock::now();
    while (at_ < blocks_.end()) {
      if (job_.stop.stop_requested()) {
        save();
        throw Stopped();
      }
      next_block();
      if (job_.progress) job_.progress(at_ - from, blocks_.end() - from);
      if (std::chrono::duration<double>(Clock::now() - saved).count() < options_.checkpoint_seconds) continue;
      save();
      saved = Clock::now();
    }
    require_unchanged();
    // What is computed now is written to the disk later, which may fail.
    save();
    if (sums_.points() > 0) return;
    throw InputError({.file = request_.scan_file},
                     not_finite_ > 0 ? fmt::format("none of the {} points has coordinates", not_finite_)
                                     : std::string("there is no point"),
                     "the points of a scan");
  }

  ScanDeviations result();

 private:
  void require_unchanged() const {
    if (file_stamp(request_.scan_file) == stamp_) return;
    throw InputError(
        {.file = request_.scan_file},
        fmt::format("was changed while it was read, at byte {}, behind point {}", at_, sums_.points() + not_finite_),
        "a file that nobody changes meanwhile");
  }

  void next_block() {
    require_unchanged();
    const std::size_t end = blocks_.block_end(at_, options_.block);
    const CloudBlock block = blocks_.read(at_, end, request_.threads);
    const RigidTransform& pose = request_.pose.transform;
    const Eigen::Matrix3Xd points = (pose.rotation * block.points).colwise() + pose.translation;
    if (points.cols() > 0) {
      sums_.add(points, surface_.closest(points, request_.threads, job_.stop), request_.threads);
    }
    not_finite_ += block.not_finite;
    at_ = end;
    file_.forget(end);
  }

  void save() {
    if (!unfinished_) return;
    std::string state(2 * sizeof(std::uint64_t), '\0');
    const std::uint64_t place[2] = {at_, not_finite_};
    std::memcpy(state.data(), place, sizeof place);
    unfinished_->save(state + sums_.state());
  }

  void go_on() {
    const std::string& state = unfinished_->found();
    std::uint64_t place[2] = {0, 0};
    const auto refuse = [&] {
      throw InputError({.file = unfinished_name(options_.output).string()}, "is damaged",
                       "a checkpoint of this job; or remove the file, to begin anew");
    };
    if (state.size() < sizeof place) refuse();
    std::memcpy(place, state.data(), sizeof place);
    if (place[0] < blocks_.begin() || place[0] > blocks_.end()) refuse();
    try {
      sums_.set_state(std::string_view(state).substr(sizeof place));
    } catch (const std::invalid_argument&) {
      refuse();
    }
    at_ = place[0];
    not_finite_ = place[1];
    if (!options_.tell) return;
    options_.tell(fmt::format("{}: goes on behind point {}", unfinished_name(options_.output).string(),
                              sums_.points() + not_finite_));
  }

  const ScanDeviationsRequest& request_;
  const StreamingOptions& options_;
  const JobOptions& job_;
  FileStamp stamp_;
  MappedFile file_;
  PointCloudBlocks blocks_;
  ClosestPointFinder surface_;
  SurfaceFaces faces_;
  SurfaceDeviationOptions statistics_;
  DeviationSums sums_;
  std::size_t at_;
  std::uint64_t not_finite_ = 0;
  std::shared_ptr<Checkpoint> unfinished_;
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
  if (not_finite_ > 0) {
    scan.notes.push_back(fmt::format("{} left out: not all of their coordinates are finite numbers",
                                     not_finite_ == 1 ? "1 point is" : fmt::format("{} points are", not_finite_)));
  }
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
  result.unfinished = unfinished_;
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
    request.scan = read_point_cloud(request.scan_file, scan);
    return find_deviations(request, job.stop);
  }
  check_deviation_request(request);
  if (request.part.mesh.size() == 0) {
    throw InputError({.file = request.part_file}, "there is no triangle", "the surface of a part");
  }
  StreamJob stream(request, scan, options, job);
  stream.read();
  return stream.result();
}

}  // namespace abbe
