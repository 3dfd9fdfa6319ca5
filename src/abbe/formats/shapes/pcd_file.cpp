#include "abbe/formats/shapes/pcd_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "abbe/formats/shapes/found_points.h"
#include "abbe/formats/shapes/lzf.h"
#include "abbe/formats/shapes/pcd_header.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/line_numbers.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

static_assert(std::endian::native == std::endian::little, "the numbers of PCD files are those of PCs");

constexpr std::array<const char*, 6> kPcdWanted = {"x", "y", "z", "normal_x", "normal_y", "normal_z"};
/// Points whose numbers are converted together.
constexpr std::size_t kPcdTogether = 1024;

/// The values of one field: where that of the first point is, and how far apart they are.
struct PcdColumn {
  const char* first = nullptr;
  std::size_t stride = 0;
  char type = 'F';
  std::size_t size = 4;

  template <typename Number>
  void convert(std::size_t begin, std::size_t count, double* out) const {
    const char* at = first + begin * stride;
    for (std::size_t i = 0; i < count; ++i, at += stride) {
      Number number;
      std::memcpy(&number, at, sizeof number);
      out[i] = static_cast<double>(number);
    }
  }

  /// Values of the points begin, begin + 1, ...
  void read(std::size_t begin, std::size_t count, double* out) const {
    if (type == 'F') return size == 8 ? convert<double>(begin, count, out) : convert<float>(begin, count, out);
    const bool is_signed = type == 'I';
    switch (size) {
      case 1:
        return is_signed ? convert<std::int8_t>(begin, count, out) : convert<std::uint8_t>(begin, count, out);
      case 2:
        return is_signed ? convert<std::int16_t>(begin, count, out) : convert<std::uint16_t>(begin, count, out);
      case 4:
        return is_signed ? convert<std::int32_t>(begin, count, out) : convert<std::uint32_t>(begin, count, out);
      default:
        return is_signed ? convert<std::int64_t>(begin, count, out) : convert<std::uint64_t>(begin, count, out);
    }
  }
};

class PcdReader {
 public:
  PcdReader(std::string_view contents, const std::string& file, const std::optional<FileLength>& unit)
      : contents_(contents), file_(file), header_(parse_pcd_header(contents, file)) {
    result_.unit = agreed_unit(std::nullopt, unit, file);
    factor_ = millimetres(result_.unit.length);
    largest_ = kLargestInput / factor_;
    find_fields();
  }

  PointCloudFile read() {
    require_room();
    FoundPoints found(static_cast<Eigen::Index>(header_.points), fields_.size() == kPcdWanted.size());
    if (header_.form == PcdForm::ascii) {
      result_.format = "PCD, ascii";
      read_lines(found);
    } else if (header_.form == PcdForm::binary) {
      result_.format = "PCD, binary";
      read_columns(contents_.substr(header_.data), found);
      require_end(header_.data + static_cast<std::size_t>(header_.points) * header_.point_bytes);
    } else {
      result_.format = "PCD, compressed";
      const std::string data = decompressed();
      read_columns(data, found);
    }
    found.finish(file_, result_);
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(std::string field, std::string problem, std::string expected) const {
    throw InputError({.file = file_, .field = std::move(field)}, std::move(problem), std::move(expected));
  }

  void find_fields() {
    for (std::size_t k = 0; k < kPcdWanted.size(); ++k) {
      const PcdField* found = nullptr;
      for (const PcdField& field : header_.fields) {
        if (field.name != kPcdWanted[k]) continue;
        if (found != nullptr) refuse("FIELDS", fmt::format("{} is given twice", kPcdWanted[k]), "");
        if (field.count != 1) refuse("COUNT", fmt::format("{} has {} values", kPcdWanted[k], field.count), "1");
        found = &field;
      }
      if (found != nullptr) {
        fields_.push_back(found);
      } else if (k < 3) {
        refuse("FIELDS", fmt::format("there is no field {}", kPcdWanted[k]), "x y z");
      }
    }
    if (fields_.size() != 3 && fields_.size() != kPcdWanted.size()) {
      refuse("FIELDS", "there is only a part of a normal", "normal_x normal_y normal_z or none of them");
    }
    for (std::size_t k = 0; k < fields_.size(); ++k) in_order_.emplace_back(fields_[k]->words, k);
    std::sort(in_order_.begin(), in_order_.end());
  }

  /// What the header promises must fit into the file before memory is taken for it.
  void require_room() const {
    const std::size_t left = contents_.size() - header_.data;
    // A digit and a space; the last value of a file may have nothing after it.
    std::uint64_t room = (left + 1) / (2 * header_.point_words), least = 2 * header_.point_words;
    if (header_.form != PcdForm::ascii) {
      least = header_.point_bytes;
      room = left / least;
      if (header_.form == PcdForm::binary_compressed) room = left * kLzfLargestGrowth / least;
    }
    if (header_.points <= room) return;
    throw InputError({file_, header_.line, 0, "POINTS"},
                     fmt::format("{} are stated, but only {} bytes are left for them", header_.points, left),
                     header_.form == PcdForm::binary_compressed ? "data that decompress to more"
                                                                : fmt::format("at least {} bytes for each", least));
  }

  /// After the points there may be zeros and line ends only, so that no number of points is too small.
  void require_end(std::size_t end) const {
    const std::size_t more = contents_.find_first_not_of(std::string_view("\0\r\n \t", 5), end);
    if (more == std::string_view::npos) return;
    refuse("POINTS", fmt::format("at byte {}: the file continues after its {} points", more, header_.points),
           "the end of the file");
  }

  std::string decompressed() const {
    std::array<std::uint32_t, 2> sizes;
    if (contents_.size() - header_.data < sizeof sizes) {
      refuse("DATA", fmt::format("at byte {}: the file ends", contents_.size()), "two sizes of 4 bytes");
    }
    std::memcpy(sizes.data(), contents_.data() + header_.data, sizeof sizes);
    const std::size_t begin = header_.data + sizeof sizes, size = sizes[0];
    if (contents_.size() - begin < size) {
      refuse("DATA",
             fmt::format("at byte {}: {} bytes of compressed data are stated, but only {} are left", header_.data, size,
                         contents_.size() - begin),
             "");
    }
    const std::uint64_t expected = header_.points * header_.point_bytes;
    if (sizes[1] != expected) {
      refuse("DATA", fmt::format("at byte {}: the data decompress to {} bytes", header_.data + 4, sizes[1]),
             fmt::format("{}: {} points of {} bytes", expected, header_.points, header_.point_bytes));
    }
    require_end(begin + size);
    std::string data(static_cast<std::size_t>(expected), '\0');
    if (!lzf_decompress(contents_.substr(begin, size), data)) {
      refuse("DATA", fmt::format("at byte {}: the compressed data are damaged", begin),
             fmt::format("LZF data of {} bytes that decompress to {}", size, expected));
    }
    return data;
  }

  void read_columns(std::string_view data, FoundPoints& found) const {
    const bool is_compressed = header_.form == PcdForm::binary_compressed;
    const auto points = static_cast<std::size_t>(header_.points);
    std::array<PcdColumn, 6> columns;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      const PcdField& field = *fields_[k];
      // Compressed, all values of a field stand together.
      columns[k] = is_compressed ? PcdColumn{data.data() + points * field.offset, field.size, field.type, field.size}
                                 : PcdColumn{data.data() + field.offset, header_.point_bytes, field.type, field.size};
    }
    std::array<std::array<double, kPcdTogether>, 6> values;
    for (std::size_t begin = 0; begin < points; begin += kPcdTogether) {
      const std::size_t count = std::min(kPcdTogether, points - begin);
      for (std::size_t k = 0; k < fields_.size(); ++k) columns[k].read(begin, count, values[k].data());
      for (std::size_t i = 0; i < count; ++i) {
        std::array<double, 6> point;
        for (std::size_t k = 0; k < fields_.size(); ++k) point[k] = values[k][i];
        if (const int wrong = add(point, found); wrong >= 0) {
          const auto k = static_cast<std::size_t>(wrong);
          const std::string place =
              is_compressed
                  ? ""
                  : fmt::format("at byte {}: ", header_.data + (begin + i) * header_.point_bytes + fields_[k]->offset);
          refuse(kPcdWanted[k], fmt::format("{}point {}: {:g} is too large", place, begin + i, point[k]),
                 fmt::format("a number of at most {:g}", largest_));
        }
      }
    }
  }

  /// Keeps a point or leaves it out. @returns the coordinate that is too large, or -1
  int add(const std::array<double, 6>& values, FoundPoints& found) const {
    const Eigen::Vector3d point(values[0], values[1], values[2]);
    if (!point.allFinite()) {
      found.leave_out_not_finite();
      return -1;
    }
    for (int k = 0; k < 3; ++k) {
      if (std::abs(point[k]) > largest_) return k;
    }
    if (fields_.size() == kPcdWanted.size()) {
      found.keep(factor_ * point, {values[3], values[4], values[5]});
    } else {
      found.keep(factor_ * point);
    }
    return -1;
  }

  void read_lines(FoundPoints& found) const {
    std::uint64_t read = 0;
    std::size_t at = header_.data;
    for (; at < contents_.size() && read < header_.points;) {
      const std::string_view line = csv_next_line(contents_, at);
      const char* const start = skip_spaces(line.data(), line.data() + line.size());
      if (start == line.data() + line.size()) continue;
      read_line(line, start, found);
      ++read;
    }
    if (read < header_.points) {
      refuse("POINTS", fmt::format("{} are stated, but the file ends after {}", header_.points, read),
             "a line for each");
    }
    require_end(at);
  }

  [[noreturn]] void refuse_word(const char* at, std::string field, std::string problem, std::string expected) const {
    throw_refusal(
        contents_, file_,
        {static_cast<std::size_t>(at - contents_.data()), std::move(field), std::move(problem), std::move(expected)});
  }

  void read_line(std::string_view line, const char* at, FoundPoints& found) const {
    const char* const end = line.data() + line.size();
    std::array<double, 6> point;
    std::array<const char*, 6> places;
    std::size_t word = 0;
    const auto pass_over = [&](std::size_t until) {
      for (; word < until && at != end; ++word) at = skip_spaces(word_end(at, end), end);
    };
    for (const auto& [order, k] : in_order_) {
      pass_over(order);
      if (at == end) break;
      places[k] = at;
      at = skip_spaces(read_value(at, end, k, point[k]), end);
      ++word;
    }
    pass_over(header_.point_words);
    if (word != header_.point_words || at != end) {
      refuse_word(line.data(), "",
                  word == header_.point_words ? fmt::format("the line has more than {} values", word)
                                              : fmt::format("the line has {} values", word),
                  fmt::format("{}, as FIELDS and COUNT say", header_.point_words));
    }
    if (const int wrong = add(point, found); wrong >= 0) {
      const auto k = static_cast<std::size_t>(wrong);
      refuse_word(places[k], kPcdWanted[k], fmt::format("{:g} is too large", point[k]),
                  fmt::format("a number of at most {:g}", largest_));
    }
  }

  const char* read_value(const char* at, const char* end, std::size_t k, double& value) const {
    NumberProblem problem = NumberProblem::none;
    if (const char* const behind = read_line_number(at, end, std::numeric_limits<double>::max(), value, problem)) {
      return behind;
    }
    // PCL writes "nan" for what it has not measured.
    const char* const behind = word_end(at, end);
    if (problem == NumberProblem::not_finite) {
      value = std::numeric_limits<double>::quiet_NaN();
      return behind;
    }
    refuse_word(
        at, kPcdWanted[k],
        fmt::format("'{}' {}", shown_word({at, static_cast<std::size_t>(behind - at)}), number_problem_words(problem)),
        fmt::format("a number of at most {:g}, or nan", largest_));
  }

  std::string_view contents_;
  const std::string& file_;
  PcdHeader header_;
  std::vector<const PcdField*> fields_;                        ///< of kPcdWanted
  std::vector<std::pair<std::size_t, std::size_t>> in_order_;  ///< words before it in a line, index in fields_
  double factor_ = 1;
  double largest_ = 0;
  PointCloudFile result_;
};

}  // namespace

PointCloudFile parse_pcd(std::string_view contents, const std::string& file, const std::optional<FileLength>& unit) {
  return PcdReader(contents, file, unit).read();
}

}  // namespace abbe
