// Names of the figures of circular tests, axes of rotation, lines, contours, linkages and thermal tests in the
// languages of reports.
#include <array>
#include <string_view>

#include "abbe/report/customer/customer_tests.h"

namespace abbe {
namespace {

/// In the languages other than English.
using Names = std::array<const char*, kReportLanguageCount - 1>;

/// A figure by its symbol, or by its name in English; a symbol that ends in "_" is the beginning of one. Names have
/// places for what it is about.
struct NamedTestFigure {
  std::string_view kind, symbol;
  Names names;
};

/// German as in DIN ISO 230, Chinese as in GB/T 17421, Japanese as in JIS B 6190.
constexpr NamedTestFigure kTestFigures[] = {
    {"circular", "G_cw", {"Kreisabweichung im Uhrzeigersinn", "圆偏差，顺时针", "円偏差、時計回り"}},
    {"circular", "G_ccw", {"Kreisabweichung gegen den Uhrzeigersinn", "圆偏差，逆时针", "円偏差、反時計回り"}},
    {"circular",
     "Fmax_cw",
     {"größte Radialabweichung im Uhrzeigersinn", "最大径向偏差，顺时针", "最大半径偏差、時計回り"}},
    {"circular",
     "Fmax_ccw",
     {"größte Radialabweichung gegen den Uhrzeigersinn", "最大径向偏差，逆时针", "最大半径偏差、反時計回り"}},
    {"circular",
     "Fmin_cw",
     {"kleinste Radialabweichung im Uhrzeigersinn", "最小径向偏差，顺时针", "最小半径偏差、時計回り"}},
    {"circular",
     "Fmin_ccw",
     {"kleinste Radialabweichung gegen den Uhrzeigersinn", "最小径向偏差，逆时针", "最小半径偏差、反時計回り"}},
    {"circular", "G_b", {"beidseitige Kreisabweichung G(b)", "双向圆偏差 G(b)", "両方向円偏差 G(b)"}},
    {"circular", "D", {"mittlere beidseitige Radialabweichung", "平均双向径向偏差", "平均両方向半径偏差"}},
    {"circular", "radius", {"mittlerer Radius minus Nennradius", "平均半径减标称半径", "平均半径と呼び半径の差"}},
    {"circular",
     "scale_mismatch",
     {"Maßstabsabweichung von {} minus der von {}", "{} 轴与 {} 轴的比例误差之差", "{} 軸と {} 軸のスケール誤差の差"}},
    {"circular", "scale_", {"Maßstabsabweichung von {}", "{} 轴的比例误差", "{} 軸のスケール誤差"}},
    {"circular",
     "squareness",
     {"Winkel zwischen +{} und +{} minus 90°", "+{} 与 +{} 的夹角减 90°", "+{} と +{} のなす角と 90° の差"}},
    {"circular", "reversal_", {"Umkehrspanne B von {}", "{} 轴反向差值 B", "{} 軸の反転値 B"}},
    {"circular",
     "centre_",
     {"Mittelpunkt der Bahn in {} (Aufbau)", "轨迹圆心沿 {}（安装）", "経路の中心、{} 方向（設置）"}},
    {"circular",
     "servo_mismatch",
     {"Schleppabweichung von {} minus der von {}", "{} 轴与 {} 轴的跟随误差之差", "{} 軸と {} 軸の追従誤差の差"}},
    {"circular", "lag_mismatch", {"dieselbe als Zeitkonstante", "同上，以时间常数表示", "同上、時定数"}},
    {"straightness",
     "straightness_ls",
     {"Geradheitsabweichung, Ausgleichsgerade", "直线度误差，最小二乘直线", "真直度誤差、最小二乗直線"}},
    {"straightness",
     "straightness_mz",
     {"Geradheitsabweichung, Minimumzone", "直线度误差，最小区域", "真直度誤差、最小領域"}},
    {"straightness", "slope_ls", {"Neigung der Ausgleichsgeraden", "最小二乘直线的斜率", "最小二乗直線の傾き"}},
    {"straightness", "slope_mz", {"Neigung der Minimumzone", "最小区域的斜率", "最小領域の傾き"}},
    {"squareness",
     "squareness",
     {"Winkel zwischen +{} und +{} minus 90°", "+{} 与 +{} 的夹角减 90°", "+{} と +{} のなす角と 90° の差"}},
    {"squareness", "straightness_", {"Geradheitsabweichung von {}", "{} 的直线度误差", "{} の真直度誤差"}},
    {"squareness", "slope_", {"Neigung von {} gegen den Winkel", "{} 相对角尺的斜率", "直角定規に対する {} の傾き"}},
    {"contour",
     "contour_mean",
     {"Konturabweichung, mittlerer Betrag", "轮廓误差，平均绝对值", "輪郭誤差、絶対値の平均"}},
    {"contour", "contour_max", {"Konturabweichung, größter Betrag", "轮廓误差，最大绝对值", "輪郭誤差、絶対値の最大"}},
    {"contour",
     "contour_s",
     {"Konturabweichung, Standardabweichung der Beträge", "轮廓误差，绝对值的标准偏差", "輪郭誤差、絶対値の標準偏差"}},
    {"contour",
     "bias",
     {"Mittel der Konturabweichungen mit Vorzeichen", "带符号轮廓误差的平均值", "符号付き輪郭誤差の平均"}},
    {"contour",
     "rounding_mean",
     {"Verrundung P1 P2, mittlerer Betrag", "圆角 P1 P2，平均绝对值", "丸み P1 P2、絶対値の平均"}},
    {"contour",
     "rounding_max",
     {"Verrundung P1 P2, größter Betrag", "圆角 P1 P2，最大绝对值", "丸み P1 P2、絶対値の最大"}},
    {"contour",
     "rounding_s",
     {"Verrundung P1 P2, Standardabweichung der Beträge", "圆角 P1 P2，绝对值的标准偏差",
      "丸み P1 P2、絶対値の標準偏差"}},
    {"contour", "radius", {"mittlerer Radius der Kante", "边缘的平均半径", "縁の平均半径"}},
    {"contour",
     "height_mean",
     {"Abweichung aus der Fläche, mittlerer Betrag", "垂直于表面的偏差，平均绝对值", "面に直角な偏差、絶対値の平均"}},
    {"contour",
     "height_max",
     {"Abweichung aus der Fläche, größter Betrag", "垂直于表面的偏差，最大绝对值", "面に直角な偏差、絶対値の最大"}},
    {"contour",
     "height_s",
     {"Abweichung aus der Fläche, Standardabweichung der Beträge", "垂直于表面的偏差，绝对值的标准偏差",
      "面に直角な偏差、絶対値の標準偏差"}},
    {"contour", "distance_mean", {"Abstand im Raum, mittlerer Betrag", "空间距离，平均值", "空間距離、平均"}},
    {"contour", "distance_max", {"Abstand im Raum, größter Betrag", "空间距离，最大值", "空間距離、最大"}},
    {"contour",
     "distance_s",
     {"Abstand im Raum, Standardabweichung der Beträge", "空间距离，标准偏差", "空間距離、標準偏差"}},
    {"linkage",
     "R_A",
     {"von der Achse A zum Brennpunkt, entlang des Strahls", "沿光束从 A 轴线到焦点",
      "A 軸から焦点まで、ビームに沿って"}},
    {"linkage",
     "R_C1",
     {"von der Achse C1 zum Strahl, entlang der Achse A", "沿 A 轴线从 C1 轴线到光束",
      "C1 軸からビームまで、A 軸に沿って"}},
    {"linkage",
     "L_tA",
     {"Versatz des Strahls gegen die Achse A", "光束相对 A 轴线的偏置", "A 軸に対するビームのオフセット"}},
    {"linkage",
     "L_AC1",
     {"Versatz der Achse A gegen die Achse C1", "A 轴线相对 C1 轴线的偏置", "C1 軸に対する A 軸のオフセット"}},
    {"linkage",
     "x0",
     {"X, bei dem die Achsen C1 und C2 zusammenfallen", "C1 与 C2 轴线重合时的 X", "C1 軸と C2 軸が一致する X"}},
    {"linkage",
     "y0",
     {"Y, bei dem die Achsen C1 und C2 zusammenfallen", "C1 与 C2 轴线重合时的 Y", "C1 軸と C2 軸が一致する Y"}},
    {"linkage",
     "z0",
     {"Z, bei dem die Achse A auf Höhe des Tisches ist", "A 轴线与工作台等高时的 Z",
      "A 軸がテーブルと同じ高さになる Z"}},
    {"etve", "ETVE_", {"ETVE von {} über die Prüfung", "试验期间 {} 的 ETVE", "試験全体の {} の ETVE"}},
    {"etve",
     "ETVE1h_",
     {"größte ETVE von {} in einer Stunde", "{} 在一小时内的最大 ETVE", "{} の 1 時間内の最大 ETVE"}},
    {"etve", "T_", {"Temperaturspanne von {}", "{} 的温度变化范围", "{} の温度範囲"}},
    {"etve",
     "rate_",
     {"größte Temperaturänderung von {} in einer Stunde", "{} 在一小时内的最大温度变化",
      "{} の 1 時間内の最大温度変化"}},
    {"etve", "NDE", {"nominelle Differenz der Wärmeausdehnung der Länge", "长度的名义热膨胀差", "長さの公称熱膨張差"}},
    {"etve",
     "U_L",
     {"erweiterte Unsicherheit der Länge durch die Temperatur (k = 2)", "温度引起的长度扩展不确定度 (k = 2)",
      "温度による長さの拡張不確かさ (k = 2)"}},
    {"spindle-distortion",
     "d60_",
     {"Spanne von {} in den ersten 60 min der Drehung", "旋转最初 60 min 内 {} 的变化范围",
      "回転開始から 60 min の {} の範囲"}},
    {"spindle-distortion",
     "d_",
     {"Spanne von {} über die Dauer der Drehung", "旋转期间 {} 的变化范围", "回転中の {} の範囲"}},
    {"spindle-distortion",
     "dcool_",
     {"Spanne von {} nach dem Stillstand", "停止后 {} 的变化范围", "停止後の {} の範囲"}},
    {"spindle-distortion",
     "tau_",
     {"Zeitkonstante von {} beim Erwärmen", "升温时 {} 的时间常数", "昇温時の {} の時定数"}},
    {"location-distortion",
     "d60_",
     {"Spanne von {} in den ersten 60 min der Erwärmung", "加热最初 60 min 内 {} 的变化范围",
      "加熱開始から 60 min の {} の範囲"}},
    {"location-distortion",
     "d_",
     {"Spanne von {} über die Dauer der Erwärmung", "加热期间 {} 的变化范围", "加熱中の {} の範囲"}},
    {"location-distortion",
     "dcool_",
     {"Spanne von {} nach dem Ende der Erwärmung", "加热结束后 {} 的变化范围", "加熱終了後の {} の範囲"}},
    {"location-distortion",
     "tau_",
     {"Zeitkonstante von {} beim Erwärmen", "升温时 {} 的时间常数", "昇温時の {} の時定数"}},
    {"axis-distortion",
     "d_L",
     {"Spanne des Abstands der äußeren Ziele", "两端目标间距的变化范围", "両端目標間距離の範囲"}},
    {"axis-distortion",
     "d_L+",
     {"Spanne des Abstands der äußeren Ziele, Richtung +", "两端目标间距的变化范围，方向 +",
      "両端目標間距離の範囲、方向 +"}},
    {"axis-distortion",
     "d_L-",
     {"Spanne des Abstands der äußeren Ziele, Richtung −", "两端目标间距的变化范围，方向 −",
      "両端目標間距離の範囲、方向 −"}},
    {"axis-distortion", "d_", {"Spanne von {} über die Prüfung", "试验期间 {} 的变化范围", "試験全体の {} の範囲"}},
    {"axis-distortion",
     "expansion_",
     {"Ausdehnung des Maßstabs über die Prüfung ({})", "试验期间标尺的膨胀（{}）", "試験全体のスケールの膨張（{}）"}},
    {"axis-distortion", "tau_", {"Zeitkonstante von {}", "{} 的时间常数", "{} の時定数"}},
    {"linkage", "location error", {"Lageabweichung", "位置误差", "位置誤差"}},
    {"linkage", "tool offset error", {"Abweichung des Werkzeugversatzes", "刀具偏置误差", "工具オフセット誤差"}},
};

/// Error motions by the beginning of their symbols: "radial_x1_total".
constexpr NamedTestFigure kMotionNames[] = {
    {"", "radial_x1_", {"radial in X, Ebene 1", "沿 X 径向，平面 1", "X 方向半径、平面 1"}},
    {"", "radial_y1_", {"radial in Y, Ebene 1", "沿 Y 径向，平面 1", "Y 方向半径、平面 1"}},
    {"",
     "radial_rotating_1_",
     {"radial, umlaufende Richtung, Ebene 1", "径向，旋转方向，平面 1", "半径、回転方向、平面 1"}},
    {"", "radial_x2_", {"radial in X, Ebene 2", "沿 X 径向，平面 2", "X 方向半径、平面 2"}},
    {"", "radial_y2_", {"radial in Y, Ebene 2", "沿 Y 径向，平面 2", "Y 方向半径、平面 2"}},
    {"",
     "radial_rotating_2_",
     {"radial, umlaufende Richtung, Ebene 2", "径向，旋转方向，平面 2", "半径、回転方向、平面 2"}},
    {"", "tilt_x_", {"Kippung nach X", "向 X 倾斜", "X 方向への傾斜"}},
    {"", "tilt_y_", {"Kippung nach Y", "向 Y 倾斜", "Y 方向への傾斜"}},
    {"", "tilt_rotating_", {"Kippung, umlaufende Richtung", "倾斜，旋转方向", "傾斜、回転方向"}},
    {"", "axial_", {"axial", "轴向", "軸方向"}},
    {"", "face_", {"Planseite", "端面", "端面"}},
};

/// Their parts.
constexpr NamedTestFigure kMotionParts[] = {
    {"", "asynchronous", {"asynchrone Bewegungsabweichung", "异步误差运动", "非同期誤差運動"}},
    {"", "synchronous", {"synchrone Bewegungsabweichung", "同步误差运动", "同期誤差運動"}},
    {"", "total", {"gesamte Bewegungsabweichung", "总误差运动", "全誤差運動"}},
    {"", "fundamental", {"Grundbewegungsabweichung", "基波误差运动", "基本誤差運動"}},
    {"", "residual", {"restliche synchrone Bewegungsabweichung", "残余同步误差运动", "残留同期誤差運動"}},
};

std::string filled_name(std::string_view name, const std::vector<std::string>& places) {
  std::string filled;
  for (const std::string& place : places) {
    const std::size_t at = name.find("{}");
    if (at == std::string_view::npos) break;
    filled += std::string(name.substr(0, at)) + place;
    name.remove_prefix(at + 2);
  }
  return filled + std::string(name);
}

std::string motion_name(const std::string& symbol, std::size_t language) {
  for (const NamedTestFigure& motion : kMotionNames) {
    if (!symbol.starts_with(motion.symbol)) continue;
    for (const NamedTestFigure& part : kMotionParts) {
      if (symbol.substr(motion.symbol.size()) != part.symbol) continue;
      return std::string(motion.names[language]) + ": " + part.names[language];
    }
  }
  return "";
}

}  // namespace

std::string test_figure_name(const std::string& kind, const EvaluationFigure& figure, ReportLanguage language) {
  if (language == ReportLanguage::english) return figure.name;
  const std::size_t index = static_cast<std::size_t>(language) - 1;
  for (const NamedTestFigure& named : kTestFigures) {
    const bool is_it = named.symbol.ends_with('_') ? figure.symbol.starts_with(named.symbol)
                                                   : figure.symbol == named.symbol || figure.name == named.symbol;
    if (named.kind == kind && is_it) return filled_name(named.names[index], figure.about);
  }
  const std::string motion = kind == "rotation" ? motion_name(figure.symbol, index) : "";
  return motion.empty() ? figure.name : motion;
}

}  // namespace abbe
