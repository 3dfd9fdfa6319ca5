#include "abbe/report/customer/customer_style.h"

#include <fmt/format.h>

#include <array>

#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

// No grid, no gaps and no variables in shorthands: WeasyPrint 57 of Debian 12 does not know them.
constexpr const char* kStyle = R"css(
:root{color-scheme:light}
*{box-sizing:border-box}
body{margin:0 auto;max-width:184mm;color:#1a2127;background:#fff;font-size:9.5pt;line-height:1.35;
font-family:'Liberation Sans',Arial,Helvetica,'Noto Sans',sans-serif;font-variant-numeric:tabular-nums}
:lang(zh){font-family:'Liberation Sans',Arial,'Noto Sans CJK SC','Noto Sans SC','Microsoft YaHei','PingFang SC',
'WenQuanYi Zen Hei',sans-serif}
:lang(ja){font-family:'Liberation Sans',Arial,'Noto Sans CJK JP','Noto Sans JP','Yu Gothic','Hiragino Sans',
'IPAexGothic',sans-serif}
@media screen{body{padding:8mm}}
header{border-bottom:1.2pt solid #1a2127;margin-bottom:4mm;padding-bottom:1.5mm;display:table;width:100%}
h1{font-size:17pt;margin:0;display:table-cell}
header p{font-size:12pt;margin:0;text-align:right;display:table-cell;padding-left:6mm}
h2,caption{font-size:11pt;font-weight:bold;margin:5mm 0 1.5mm;text-align:left;break-after:avoid}
dl{margin:0 0 1.8mm}
dl div{display:inline-block;width:48.5%;margin:0 1% 1.2mm 0;vertical-align:top}
dt{float:left;width:36mm;color:#56616b}
dd{margin:0 0 0 38mm;overflow-wrap:anywhere}
i{color:#56616b}
table{border-collapse:collapse;width:100%;margin:4mm 0 2mm;font-size:8.5pt}
caption{margin:0;padding-bottom:1.2mm}
th{font-weight:bold;border-bottom:.8pt solid #1a2127;vertical-align:bottom}
td{border-bottom:.3pt solid #aab3ba;vertical-align:top}
th,td{padding:.6mm 1.5mm;text-align:right;overflow-wrap:break-word}
th:first-child,td:first-child,.texts th,.texts td,.figures th:nth-child(2),.figures td:nth-child(2){text-align:left}
.figures td:not(:nth-child(2)),.numbers td{white-space:nowrap}
.figures td:nth-last-child(2):not(:nth-child(2)){padding-left:0}
.numbers{font-size:8pt}
thead{display:table-header-group}
.short{break-inside:avoid}
tr,figure,section.verdict,section.warning,section.signatures{break-inside:avoid}
.small{font-size:7.5pt;color:#56616b;margin:1.5mm 0 0}
.warning{border:1.2pt solid #a61b1b;padding:1.5mm 3mm;margin:3mm 0}
.warning p{margin:.6mm 0;font-weight:bold;color:#a61b1b}
.verdict{border:.8pt solid #1a2127;padding:2mm 3mm;margin:3mm 0}
.verdict h2{margin:0 0 1mm}
.verdict p{margin:.8mm 0}
.proven{color:#1b6e3a}
.refuted{color:#a61b1b;font-weight:bold}
.open{color:#8a5a00}
.none{color:#56616b}
figure{margin:4mm 0}
figure svg{display:block;width:100%;height:auto;max-height:74mm}
figcaption{font-size:8pt;color:#56616b}
.notes{font-size:8pt}
.notes ul{margin:0;padding-left:5mm}
.signatures div div{display:inline-block;width:46%;margin-right:3%}
.signatures p{margin:7.5mm 0 0;border-top:.6pt solid #1a2127;font-size:7.5pt;color:#56616b;padding-top:.5mm}
)css";

}  // namespace

std::string customer_style(std::string_view foot) {
  constexpr const char* kFoot = "font:7.5pt 'Liberation Sans',Arial,sans-serif;color:#56616b";
  return fmt::format(
      "@page{{size:A4;margin:14mm 13mm 16mm;@bottom-left{{content:{};{}}}"
      "@bottom-right{{content:counter(page) \" / \" counter(pages);{}}}}}{}",
      style_string(foot), kFoot, kFoot, kStyle);
}

std::string style_string(std::string_view text) {
  std::string quoted = "\"";
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0) {
      quoted += "\\fffd ";
      ++at;
      continue;
    }
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[at + i]); };
    constexpr std::array<unsigned, 5> kLeadBits = {0, 0x7f, 0x1f, 0x0f, 0x07};
    unsigned character = byte(0) & kLeadBits[length];
    for (std::size_t i = 1; i < length; ++i) character = character << 6 | (byte(i) & 0x3fU);
    const bool is_plain = length == 1 && (character == ' ' || (character >= '0' && character <= '9') ||
                                          ((character | 0x20U) >= 'a' && (character | 0x20U) <= 'z'));
    // A style sheet has no character 0.
    quoted += is_plain ? std::string(1, text[at]) : fmt::format("\\{:x} ", character == 0 ? 0xfffdU : character);
    at += length;
  }
  return quoted + "\"";
}

}  // namespace abbe
