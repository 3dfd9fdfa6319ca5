#include <abbe/study/scan_registration.h>

#include <cstdio>
#include <utility>

int main(int /*argc*/, char** arguments) {
  abbe::ScanRegistrationRequest request;
  request.scan_file = arguments[1];
  request.part_file = arguments[2];
  request.scan = abbe::read_point_cloud(request.scan_file);
  request.part = abbe::read_mesh(request.part_file);
  const abbe::ScanRegistration result = abbe::register_scan(std::move(request));
  std::fputs(abbe::scan_registration_text(result).c_str(), stdout);
  return result.is_ok() ? 0 : 1;
}
