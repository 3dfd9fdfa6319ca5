#pragma once

// Internal to study: what find_deviations() and deviations_of_file() do alike.
#include <optional>
#include <string>

#include "abbe/report/evaluations/deviation_report.h"
#include "abbe/study/scans/scan_deviations.h"

namespace abbe {

/// Refuses a transform where the registration that wrote it found no pose, and a band that is upside down.
/// @throws InputError
void check_deviation_request(const ScanDeviationsRequest& request);

/// The faces that were asked for. @throws InputError if the file of the part states none
SurfaceFaces faces_of_part(const ScanDeviationsRequest& request);

/// Notes a scan that is not where its part is. A scan on its part has half of its points within a tenth of the part's
/// diagonal even where the part is badly made or much of its surroundings was scanned too.
/// @param middle_mm  half of the points that count are farther away
void note_scan_elsewhere(const MeshFile& part, double middle_mm, ScanDeviations& result);

DeviationRequest asked_of_report(const ScanDeviationsRequest& request);

/// Deviations of a scan that fits into memory, which is read and compared in pieces. No closest point is kept beyond
/// what files and pages need.
/// @returns nothing where the whole file has to be read
std::optional<ScanDeviations> deviations_in_pieces(const ScanDeviationsRequest& request, const PointCloudOptions& scan,
                                                   const JobOptions& job);

/// Everything that was asked for and that deviations depend on, beside the files and the pose.
std::string deviation_options_text(const ScanDeviationsRequest& request, const PointCloudOptions& scan);

/// Says in the notes of a scan how many points were left out because they are not finite.
void note_left_out(PointCloudFile& scan);

}  // namespace abbe
