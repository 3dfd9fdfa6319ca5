#include "abbe/formats/nc_program.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "abbe/formats/input_error.h"
#include "abbe/formats/nc_interpreter.h"
#include "abbe/formats/nc_writer.h"
#include "abbe/formats/streamed_file.h"
#include "abbe/formats/text_file.h"

namespace abbe {

NcProgramResult correct_nc_program(std::string_view text, const std::string& file, const NcProgramOptions& options,
                                   MoveCorrector& corrector, const std::function<void(std::string_view)>& write,
                                   const std::function<void(std::size_t)>& read_to) {
  NcWriter writer(file, options, corrector, write);
  NcInterpreter interpreter(text, file, options, writer);
  NcProgramResult result;
  result.lines = interpreter.run(read_to);
  writer.finish();
  result.moves = writer.moves();
  result.pieces = writer.pieces();
  result.uncorrected_moves = writer.uncorrected();
  result.first_uncorrected_line = writer.first_uncorrected_line();
  result.first_assumed_offset_line = interpreter.first_assumed_offset_line();
  return result;
}

NcProgramResult correct_nc_program_file(const std::filesystem::path& program, const std::filesystem::path& corrected,
                                        const NcProgramOptions& options, MoveCorrector& corrector) {
  std::error_code ignored;
  if (std::filesystem::equivalent(program, corrected, ignored)) {
    throw InputError({.file = corrected.string()}, "is the program itself", "another file for the corrected program");
  }
  MappedFile file(program);
  StreamedFile out(corrected);
  const NcProgramResult result = correct_nc_program(
      file.text(), program.string(), options, corrector, [&](std::string_view text) { out.append(text); },
      [&](std::size_t end) { file.forget(end); });
  out.commit();
  return result;
}

}  // namespace abbe
