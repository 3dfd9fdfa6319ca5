#include <abbe/formats/files/results_folder.h>
#include <abbe/formats/machine/machine_file.h>
#include <abbe/formats/shapes/mesh_file.h>
#include <abbe/study/planned_scan.h>

#include <cstdio>

int main(int /*argc*/, char** arguments) {
  abbe::ScanRequest request;
  request.machine = abbe::read_machine(arguments[1]);
  request.part_file = arguments[2];
  request.part = abbe::read_mesh(request.part_file).mesh;
  request.scan.range = 0.4;
  const abbe::PlannedScan planned = abbe::plan_part_scan(request);
  abbe::write_file_atomically(arguments[3], abbe::planned_scan_csv(planned));
  std::fputs(abbe::planned_scan_text(planned).c_str(), stdout);
  return planned.is_complete() ? 0 : 1;
}
