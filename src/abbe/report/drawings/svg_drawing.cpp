#include "abbe/report/drawings/svg_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

constexpr std::array<const char*, 9> kColourNames = {"s1", "s2", "s3", "s4", "s5", "s6", "ink", "soft", "limit"};

/// A colour of the style sheet on light and on dark paper.
struct NamedColour {
  const char *name, *light, *dark;
};
constexpr NamedColour kPalette[] = {
    {"paper", "#fff", "#12171b"},   {"ink", "#1a2127", "#e6eaed"},   {"soft", "#56616b", "#a3adb6"},
    {"grid", "#e3e7ea", "#2b343b"}, {"limit", "#b3261e", "#ff8a80"}, {"s1", "#0b6e75", "#5cc3c9"},
    {"s2", "#b4551d", "#e9965b"},   {"s3", "#4a5fa5", "#93a7f0"},    {"s4", "#8a3d7c", "#d68fca"},
    {"s5", "#66741a", "#b8c85c"},   {"s6", "#7d5a3c", "#c9a27e"}};

constexpr const char* kFont =
    "font-family:Inter,'Segoe UI',system-ui,-apple-system,'Helvetica Neue','Liberation Sans',Arial,sans-serif;"
    "font-variant-numeric:tabular-nums";

constexpr const char* kJoins = ".abbe-plot path,.abbe-plot circle{stroke-linejoin:round;stroke-linecap:round}";

std::string style_sheet() {
  std::string light, dark;
  for (const NamedColour& colour : kPalette) {
    light += fmt::format("--{}:{};", colour.name, colour.light);
    dark += fmt::format("{}--{}:{}", dark.empty() ? "" : ";", colour.name, colour.dark);
  }
  return fmt::format(".abbe-plot{{{}{}}}@media screen and (prefers-color-scheme:dark){{.abbe-plot{{{}}}}}{}", light,
                     kFont, dark, kJoins);
}

const char* colour_name(PlotColour colour) { return kColourNames[static_cast<std::size_t>(colour)]; }

std::string stroke(const PlotStyle& style) {
  std::string text = fmt::format(" fill=\"none\" stroke=\"var(--{})\" stroke-width=\"{:.2f}\"",
                                 colour_name(style.colour), style.width);
  if (style.dashed) text += " stroke-dasharray=\"5 4\"";
  if (style.opacity < 1) text += fmt::format(" opacity=\"{:.2f}\"", style.opacity);
  return text;
}

std::string fill(const PlotStyle& style) {
  std::string text = fmt::format(" fill=\"var(--{})\"", colour_name(style.colour));
  if (style.opacity < 1) text += fmt::format(" opacity=\"{:.2f}\"", style.opacity);
  return text;
}

/// Never "-0.00".
std::string number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  return text == "-0.00" ? "0.00" : text;
}

std::string pair(DrawingPoint point) { return number(point.x) + " " + number(point.y); }

int decimals_of(double step) {
  for (int decimals = 0; decimals < 9; ++decimals) {
    const double scaled = step * std::pow(10, decimals);
    if (std::abs(scaled - std::round(scaled)) < 1e-6 * scaled) return decimals;
  }
  return 9;
}

std::string tick_label(double value, double step) {
  // Very large and very small numbers would not fit under the axis.
  const double size = std::max(std::abs(value), step);
  const std::string text =
      size >= 1e7 || step < 1e-6 ? fmt::format("{:.6g}", value) : fmt::format("{:.{}f}", value, decimals_of(step));
  return text.starts_with('-') ? "\xE2\x88\x92" + text.substr(1) : text;
}

}  // namespace

std::string xml_text(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const char c = text[at];
    // U+FFFE and U+FFFF are no characters of XML.
    const bool none = text.substr(at, length) == "\xEF\xBF\xBE" || text.substr(at, length) == "\xEF\xBF\xBF";
    if (length == 0 || none) {
      out += "\xEF\xBF\xBD";
    } else if (length > 1) {
      out += text.substr(at, length);
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else if (c == '\n' || c == '\t' || c == '\r') {
      out += ' ';
    } else if (static_cast<unsigned char>(c) >= 0x20U && c != '\x7F') {
      out += c;
    }
    at += std::max<std::size_t>(length, 1);
  }
  return out;
}

double text_width(std::string_view text, double size) {
  // Letters of Chinese and Japanese (U+3000 to U+D7FF, U+F900 to U+FFFF) are as wide as they are high.
  const auto is_wide = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0xE3 && byte <= 0xEF && byte != 0xEE;
  };
  const auto wide = static_cast<double>(std::count_if(text.begin(), text.end(), is_wide));
  return size * (0.56 * (static_cast<double>(characters_in(text)) - wide) + wide);
}

std::vector<std::string> text_lines(std::string_view text, double width, double size) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word(text.substr(at, end - at));
    if (!lines.empty() && text_width(lines.back() + ' ' + word, size) <= width) {
      lines.back() += ' ' + word;
    } else {
      lines.push_back(word);
    }
    at = end + 1;
  }
  return lines;
}

AxisTicks nice_ticks(double low, double high, std::size_t count, bool degrees) {
  if (!std::isfinite(high - low) || low > high) {
    low = 0;
    high = 1;
  }
  const double magnitude = std::max(std::abs(low), std::abs(high));
  // A range below the resolution of its numbers cannot be divided.
  const double smallest = std::max(1e-9 * magnitude, 1e-12);
  if (high - low < smallest) {
    const double widen = magnitude > 0 ? std::max(0.05 * magnitude, smallest) : 1;
    low -= widen;
    high += widen;
  }
  const double wanted = (high - low) / static_cast<double>(std::max<std::size_t>(count, 1));
  const double power = std::pow(10, std::floor(std::log10(wanted)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= wanted * 0.999) step = factor * power;
  }
  if (degrees && wanted > 5 && wanted <= 360) {
    for (const double angle : {360.0, 180.0, 90.0, 60.0, 45.0, 30.0, 15.0, 10.0}) {
      if (angle >= wanted * 0.999) step = angle;
    }
  }
  AxisTicks ticks;
  const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
  for (double i = first; i <= last; ++i) {
    const double value = i == 0 ? 0 : i * step;
    ticks.values.push_back(value);
    ticks.labels.push_back(tick_label(value, step));
  }
  return ticks;
}

AxisTicks fitting_ticks(double low, double high, std::size_t count, bool degrees, double length) {
  for (;; --count) {
    AxisTicks ticks = nice_ticks(low, high, count, degrees);
    double widest = 0;
    for (const std::string& label : ticks.labels) widest = std::max(widest, text_width(label, 12));
    if (count <= 1 || (1.15 * widest + 8) * static_cast<double>(ticks.values.size() - 1) <= length) return ticks;
  }
}

SvgDrawing::SvgDrawing(double width, double height, std::string_view title)
    : width_(width), height_(height), title_(xml_text(title)) {}

void SvgDrawing::line(DrawingPoint from, DrawingPoint to, const PlotStyle& style) {
  const std::array<DrawingPoint, 2> points = {from, to};
  polyline(points, style);
}

void SvgDrawing::polyline(std::span<const DrawingPoint> points, const PlotStyle& style) {
  std::string path, last;
  bool open = false;
  for (const DrawingPoint point : points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      open = false;
      continue;
    }
    std::string here = pair(point);
    // Long recordings have many readings per pixel.
    if (open && here == last) continue;
    path += (open ? "L" : "M") + here;
    last = std::move(here);
    open = true;
  }
  if (!path.empty()) elements_ += fmt::format("<path d=\"{}\"{}/>\n", path, stroke(style));
}

void SvgDrawing::area(std::span<const DrawingPoint> points, const PlotStyle& style) {
  std::string path;
  for (const DrawingPoint point : points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
    path += (path.empty() ? "M" : "L") + pair(point);
  }
  if (!path.empty()) elements_ += fmt::format("<path d=\"{}Z\"{}/>\n", path, fill(style));
}

void SvgDrawing::circle(DrawingPoint centre, double radius, const PlotStyle& style) {
  if (!std::isfinite(centre.x) || !std::isfinite(centre.y) || !std::isfinite(radius)) return;
  elements_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", number(centre.x), number(centre.y),
                           number(radius), stroke(style));
}

void SvgDrawing::marker(DrawingPoint at, Marker marker, const PlotStyle& style) {
  if (!std::isfinite(at.x) || !std::isfinite(at.y)) return;
  constexpr double kSize = 4;
  std::string path;
  switch (marker) {
    case Marker::circle:
      elements_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"3\"{}/>\n", number(at.x), number(at.y), fill(style));
      return;
    case Marker::cross:
      path = "M" + pair({at.x - kSize + 1, at.y - kSize + 1}) + "L" + pair({at.x + kSize - 1, at.y + kSize - 1}) + "M" +
             pair({at.x - kSize + 1, at.y + kSize - 1}) + "L" + pair({at.x + kSize - 1, at.y - kSize + 1});
      elements_ += fmt::format("<path d=\"{}\"{}/>\n", path, stroke(style));
      return;
    case Marker::up:
    case Marker::down: {
      const double tip = marker == Marker::up ? -kSize : kSize;
      path = "M" + pair({at.x - kSize, at.y - 0.7 * tip}) + "L" + pair({at.x + kSize, at.y - 0.7 * tip}) + "L" +
             pair({at.x, at.y + tip}) + "Z";
      elements_ += fmt::format("<path d=\"{}\"{}/>\n", path, fill(style));
      return;
    }
  }
}

void SvgDrawing::dimension(double x, double y1, double y2, const PlotStyle& style) {
  if (!std::isfinite(x) || !std::isfinite(y1) || !std::isfinite(y2)) return;
  const double top = std::min(y1, y2), bottom = std::max(y1, y2);
  const double head = std::min(7.0, 0.45 * (bottom - top));
  line({x, top}, {x, bottom}, style);
  PlotStyle heads = style;
  heads.dashed = false;
  const std::array<DrawingPoint, 3> upper = {{{x - 0.4 * head, top + head}, {x, top}, {x + 0.4 * head, top + head}}};
  const std::array<DrawingPoint, 3> lower = {
      {{x - 0.4 * head, bottom - head}, {x, bottom}, {x + 0.4 * head, bottom - head}}};
  area(upper, heads);
  area(lower, heads);
}

void SvgDrawing::text(DrawingPoint at, std::string_view text, TextAnchor anchor, double size, PlotColour colour,
                      bool bold, double angle) {
  if (!std::isfinite(at.x) || !std::isfinite(at.y)) return;
  const char* const anchors[] = {"start", "middle", "end"};
  elements_ +=
      fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{:.3g}\" text-anchor=\"{}\" fill=\"var(--{})\"", number(at.x),
                  number(at.y), size, anchors[static_cast<std::size_t>(anchor)], colour_name(colour));
  if (bold) elements_ += " font-weight=\"600\"";
  if (angle != 0) elements_ += fmt::format(" transform=\"rotate({} {})\"", number(angle), pair(at));
  elements_ += fmt::format(">{}</text>\n", xml_text(text));
}

std::string SvgDrawing::svg() const {
  const std::string w = number(width_), h = number(height_);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"abbe-plot\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" role=\"img\">\n<title>{2}</title>\n<style>{3}</style>\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"var(--paper)\"/>\n{4}</svg>\n",
      w, h, title_, style_sheet(), elements_);
}

std::string svg_for_paper(std::string svg) {
  const std::string screen = style_sheet();
  if (const std::size_t at = svg.find(screen); at != std::string::npos) {
    svg.replace(at, screen.size(), fmt::format(".abbe-plot{{{}}}{}", kFont, kJoins));
  }
  for (const NamedColour& colour : kPalette) {
    const std::string variable = fmt::format("var(--{})", colour.name);
    for (std::size_t at = svg.find(variable); at != std::string::npos; at = svg.find(variable, at)) {
      svg.replace(at, variable.size(), colour.light);
    }
  }
  return svg;
}

}  // namespace abbe
