#include <abbe/report/words/evaluation_text.h>
#include <abbe/study/scan_deviations.h>

#include <cstdio>

int main(int /*argc*/, char** arguments) {
  abbe::ScanDeviationsRequest request;
  request.scan_file = arguments[1];
  request.part_file = arguments[2];
  request.transform_file = arguments[3];
  request.scan = abbe::read_point_cloud(request.scan_file);
  request.part = abbe::read_mesh(request.part_file);
  request.pose = abbe::read_transform_file(request.transform_file);
  abbe::ScanDeviations result = abbe::find_deviations(request);
  abbe::apply_tolerances({"p95_um=60"}, result.report);
  std::fputs(abbe::evaluation_text(result.report).c_str(), stdout);
  return result.has_points() && !result.report.exceeds_tolerance() ? 0 : 1;
}
