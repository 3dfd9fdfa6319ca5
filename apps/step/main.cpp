// abbe-step FILE CHORD_MM ANGLE_RAD: the faces of a STEP file as triangles on standard output, for `abbe`
// (formats/step_file.h).
//
// A process of its own, because OpenCASCADE may stop at a damaged file, and because linking it costs every start of
// `abbe` 28 ms. What went wrong on standard error: a line with the problem, perhaps one with what was expected; exit
// code 0, 2 for a bad file, 3 for a tolerance that cannot be kept.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Standard_Failure.hxx>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "abbe/formats/number_text.h"
#include "abbe/formats/step_mesh.h"
#include "shape_triangles.h"
#include "step_shape.h"

namespace {

constexpr rlim_t kProcessorSeconds = 600;

void limit(int what, rlim_t most) {
  struct rlimit now {};
  if (::getrlimit(what, &now) != 0 || now.rlim_cur <= most) return;
  now.rlim_cur = most;
  ::setrlimit(what, &now);
}

void limit_resources() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, kProcessorSeconds);
#ifndef ABBE_SANITIZED  // the sanitizer reserves terabytes of addresses
  limit(RLIMIT_AS, rlim_t{8} << 30);
#endif
}

int fail(int code, const std::string& problem, const std::string& expected = "") {
  std::fprintf(stderr, "%s\n", problem.c_str());
  if (!expected.empty()) std::fprintf(stderr, "%s\n", expected.c_str());
  std::fflush(stderr);
  return code;
}

bool write_all(int file, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::write(file, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

int convert(char** arguments, int output) {
  double chord = 0, angle = 0;
  if (abbe::parse_number(arguments[2], 0, chord) != abbe::NumberProblem::none ||
      abbe::parse_number(arguments[3], 0, angle) != abbe::NumberProblem::none || !(chord > 0) || !(angle > 0)) {
    return fail(2, "the tolerances are no numbers above zero");
  }
  abbe::StepShape read = abbe::read_step_shape(arguments[1]);
  // Thousands of millions of triangles: only a damaged file or a slip of the tolerance asks for that.
  constexpr double kFinest = 1e-7;
  if (chord < kFinest * read.size_mm) {
    return fail(
        3, fmt::format("the shape is {:.3g} mm large, too much for a chord tolerance of {:g} mm", read.size_mm, chord),
        fmt::format("a chord tolerance of at least {:.3g} mm", kFinest * read.size_mm));
  }
  abbe::StepMesh mesh = abbe::shape_triangles(read.shape, chord, angle);
  mesh.unit = std::move(read.unit);
  mesh.notes = std::move(read.notes);
  return write_all(output, abbe::step_mesh_bytes(mesh)) ? 0 : fail(2, "the triangles could not be written");
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) return fail(2, "usage: abbe-step FILE CHORD_MM ANGLE_RAD");
  limit_resources();
  // Whatever the library prints must not come among the triangles.
  const int output = ::dup(STDOUT_FILENO);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (output < 0 || nowhere < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0) return fail(2, "there is no output");
  int code = 2;
  try {
    code = convert(arguments, output);
  } catch (const abbe::ToleranceNotReached& nearest) {
    code = fail(
        3,
        fmt::format("triangles come no nearer than {:.3g} mm to the faces (the file itself allows gaps of {:.3g} mm "
                    "between faces and edges)",
                    nearest.nearest_mm, nearest.file_gap_mm),
        fmt::format("a chord tolerance of at least {:.3g} mm", 1.01 * nearest.nearest_mm));
  } catch (const Standard_Failure& failure) {
    const char* const words = failure.GetMessageString();
    fail(code,
         std::string("OpenCASCADE: ") + (words != nullptr && *words != '\0' ? words : failure.DynamicType()->Name()));
  } catch (const std::bad_alloc&) {
    fail(code, "OpenCASCADE needed more than 8 GiB of memory");
  } catch (const std::exception& error) {
    fail(code, error.what());
  }
  // Its own clean-up at the end takes time and can stop, too.
  ::_exit(code);
}
