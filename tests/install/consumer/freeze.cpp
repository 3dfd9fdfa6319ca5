#include <abbe/formats/files/results_folder.h>
#include <abbe/formats/machine/machine_file.h>
#include <abbe/study/frozen_errors.h>

#include <cstdio>

int main(int /*argc*/, char** arguments) {
  abbe::FreezeRequest request;
  request.machine = abbe::read_machine(arguments[1]);
  request.errors_file = arguments[2];
  request.errors = abbe::read_errors(request.errors_file, request.machine);
  request.limit_um = 500;
  const abbe::FrozenErrors frozen = abbe::freeze_errors(request);
  if (frozen.refused.empty()) abbe::write_file_atomically(arguments[3], frozen.bytes());
  std::fputs(abbe::frozen_errors_text(frozen, {.file = arguments[3]}).c_str(), stdout);
  return frozen.refused.empty() ? 0 : 1;
}
