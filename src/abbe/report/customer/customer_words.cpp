#include "abbe/report/customer/customer_words.h"

#include <array>
#include <cassert>

namespace abbe {
namespace {

using Word = CustomerWord;

struct WordInLanguages {
  CustomerWord word;
  std::array<const char*, kReportLanguageCount> texts;  ///< English, German, Chinese, Japanese
};

/// In the order of the enumeration. Chinese as in GB/T 17421, Japanese as in JIS B 6190, German as in DIN ISO 230.
constexpr WordInLanguages kWords[] = {
    {Word::report, {"Test report", "Prüfbericht", "检测报告", "試験成績書"}},
    {Word::linear_axis,
     {"Positioning of a linear axis", "Positionieren einer Linearachse", "线性轴线的定位", "直進軸の位置決め"}},
    {Word::rotary_axis,
     {"Positioning of a rotary axis", "Positionieren einer Drehachse", "回转轴线的定位", "回転軸の位置決め"}},
    {Word::diagonals,
     {"Positioning along diagonals", "Positionieren entlang von Diagonalen", "沿对角线的定位", "対角線上の位置決め"}},
    {Word::geometry,
     {"Geometric accuracy of the machine", "Geometrische Genauigkeit der Maschine", "机床的几何精度",
      "機械の幾何精度"}},
    {Word::report_number, {"Report number", "Berichtsnummer", "报告编号", "報告書番号"}},
    {Word::customer, {"Customer", "Kunde", "客户", "お客様"}},
    {Word::machine, {"Machine", "Maschine", "机床", "機械"}},
    {Word::serial_number, {"Serial number", "Seriennummer", "出厂编号", "製造番号"}},
    {Word::place, {"Place", "Ort", "地点", "場所"}},
    {Word::operator_name, {"Operator", "Prüfer", "检测人员", "測定者"}},
    {Word::date, {"Date of measurement", "Datum der Messung", "检测日期", "測定日"}},
    {Word::temperature, {"Temperature", "Temperatur", "温度", "温度"}},
    {Word::temperature_mean, {"mean {} °C", "Mittel {} °C", "平均 {} °C", "平均 {} °C"}},
    {Word::temperature_range, {"{} to {} °C", "{} bis {} °C", "{} 至 {} °C", "{} ～ {} °C"}},
    {Word::standard, {"Standard applied", "Angewandte Norm", "采用标准", "適用規格"}},
    {Word::remarks, {"Remarks", "Bemerkungen", "备注", "備考"}},
    {Word::not_stated, {"not stated", "nicht angegeben", "未注明", "記載なし"}},
    {Word::instruments, {"Instruments", "Messgeräte", "测量仪器", "測定器"}},
    {Word::instrument, {"Instrument", "Messgerät", "仪器", "測定器名"}},
    {Word::certificate, {"Certificate", "Kalibrierschein", "校准证书", "校正証明書"}},
    {Word::valid_until, {"Valid until", "Gültig bis", "有效期至", "有効期限"}},
    {Word::certificate_not_valid,
     {"The certificate of {} was not valid on the day of the measurement.",
      "Der Kalibrierschein von {} war am Tag der Messung nicht gültig.", "{} 的校准证书在检测当日已失效。",
      "{} の校正証明書は測定日に有効ではありませんでした。"}},
    {Word::verdict,
     {"Verdict by ISO 14253-1", "Entscheidung nach ISO 14253-1", "按 ISO 14253-1 的判定", "ISO 14253-1 による判定"}},
    {Word::conformity_proven,
     {"Conformity with the specification is proven: {}.", "Die Konformität mit der Spezifikation ist nachgewiesen: {}.",
      "证明符合规范：{}。", "仕様への適合が証明されました：{}。"}},
    {Word::nonconformity_proven,
     {"Nonconformity with the specification is proven: {}.",
      "Die Nichtkonformität mit der Spezifikation ist nachgewiesen: {}.", "证明不符合规范：{}。",
      "仕様への不適合が証明されました：{}。"}},
    {Word::not_proven,
     {"Neither conformity nor nonconformity is proven: {}.",
      "Weder Konformität noch Nichtkonformität ist nachgewiesen: {}.", "既未证明符合，也未证明不符合：{}。",
      "適合も不適合も証明されていません：{}。"}},
    {Word::no_verdict, {"No verdict: {}.", "Keine Entscheidung: {}.", "无法判定：{}。", "判定なし：{}。"}},
    {Word::short_conformity_proven, {"conformity proven", "konform", "证明符合", "適合を証明"}},
    {Word::short_nonconformity_proven, {"nonconformity proven", "nicht konform", "证明不符合", "不適合を証明"}},
    {Word::short_not_proven, {"not proven", "nicht nachgewiesen", "未能证明", "証明されず"}},
    {Word::short_no_verdict, {"no verdict", "keine Entscheidung", "无法判定", "判定なし"}},
    {Word::without_tolerance,
     {"no tolerance is stated", "es ist keine Toleranz angegeben", "未规定公差", "許容値の記載がありません"}},
    {Word::without_uncertainty,
     {"the measurement uncertainty is not known ({})", "die Messunsicherheit ist nicht bekannt ({})",
      "测量不确定度未知（{}）", "測定不確かさが不明です（{}）"}},
    {Word::without_value, {"not evaluated ({})", "nicht ausgewertet ({})", "未评定（{}）", "評価されていません（{}）"}},
    {Word::without_measurement,
     {"predicted values prove nothing; the corrected machine has to be measured",
      "vorhergesagte Werte weisen nichts nach; die korrigierte Maschine ist zu messen",
      "预测值不能作为证明，须对补偿后的机床进行测量",
      "予測値は証明になりません。補正後の機械を測定する必要があります"}},
    {Word::without_simulation,
     {"the readings are simulated", "die Messwerte sind simuliert", "读数为仿真数据",
      "測定値はシミュレーションによるものです"}},
    {Word::without_trust,
     {"the result must not be used as it is", "das Ergebnis darf so nicht verwendet werden", "该结果不可直接使用",
      "この結果はそのまま使用できません"}},
    {Word::only_identified,
     {"the uncertainty does not cover all errors of the machine ({})",
      "die Unsicherheit deckt nicht alle Abweichungen der Maschine ab ({})", "不确定度未涵盖机床的全部误差（{}）",
      "不確かさは機械のすべての誤差を含んでいません（{}）"}},
    {Word::decision_rule,
     {"Decision rule: ISO 14253-1:2017 with a conformance probability of 95 %. Guard band g = 1.65 u with u = U/2. "
      "Conformity is proven if |figure| + g ≤ tolerance, nonconformity if |figure| − g > tolerance.",
      "Entscheidungsregel: ISO 14253-1:2017 mit einer Konformitätswahrscheinlichkeit von 95 %. Sicherheitsabstand "
      "g = 1,65 u mit u = U/2. Konformität ist nachgewiesen, wenn |Kennwert| + g ≤ Toleranz, "
      "Nichtkonformität, wenn |Kennwert| − g > Toleranz.",
      "判定规则：ISO 14253-1:2017，合格概率 95 %。保护带 g = 1.65 u，u = U/2。|指标| + g ≤ 公差时证明符合，|指标| − g "
      "> "
      "公差时证明不符合。",
      "判定規則：ISO 14253-1:2017、適合確率 95 %。ガードバンド g = 1.65 u、u = U/2。|特性値| + g ≤ "
      "許容値のとき適合が、|特性値| − g > 許容値のとき不適合が証明されます。"}},
    {Word::figures, {"Figures", "Kennwerte", "评定结果", "評価結果"}},
    {Word::symbol, {"Symbol", "Zeichen", "符号", "記号"}},
    {Word::figure, {"Figure", "Kennwert", "指标", "特性値"}},
    {Word::tolerance, {"Tolerance", "Toleranz", "公差", "許容値"}},
    {Word::before, {"Before correction", "Vor der Korrektur", "补偿前", "補正前"}},
    {Word::after, {"After correction", "Nach der Korrektur", "补偿后", "補正後"}},
    {Word::measured, {"Machine as measured", "Maschine wie gemessen", "实测状态", "測定時の状態"}},
    {Word::predicted_after,
     {"Predicted after correction", "Nach Korrektur vorhergesagt", "补偿后预测", "補正後の予測"}},
    {Word::uncertainty_note,
     {"±: expanded measurement uncertainty U, coverage factor k = 2.",
      "±: erweiterte Messunsicherheit U, Erweiterungsfaktor k = 2.", "±：扩展测量不确定度 U，包含因子 k = 2。",
      "±：拡張測定不確かさ U、包含係数 k = 2。"}},
    {Word::predicted_note,
     {"Predicted after correction: largest expanded uncertainty (k = 2) of what is left when all identified errors are "
      "corrected.",
      "Nach Korrektur vorhergesagt: größte erweiterte Unsicherheit (k = 2) dessen, was bleibt, wenn alle ermittelten "
      "Abweichungen korrigiert sind.",
      "补偿后预测：全部已辨识误差补偿后残余部分的最大扩展不确定度（k = 2）。",
      "補正後の予測：同定したすべての誤差を補正した後に残る量の最大拡張不確かさ（k = 2）。"}},
    {Word::range_note,
     {"Error motions: largest minus smallest value over the range in which they are known.",
      "Bewegungsabweichungen: größter minus kleinster Wert über dem Bereich, in dem sie bekannt sind.",
      "误差运动：已知范围内最大值与最小值之差。", "誤差運動：既知の範囲における最大値と最小値の差。"}},
    {Word::convention_note,
     {"Values 0 ± 0 are zero by the conventions of ISO 230, not found from the readings.",
      "Werte 0 ± 0 sind nach den Festlegungen von ISO 230 null, nicht aus den Messwerten ermittelt.",
      "0 ± 0 为按 ISO 230 约定取零的值，并非由读数求得。",
      "0 ± 0 は ISO 230 の規約により零とした値で、測定値から求めたものではありません。"}},
    {Word::target_errors,
     {"Deviations at the target positions", "Abweichungen an den Zielpositionen", "各目标位置的偏差",
      "各目標位置における偏差"}},
    {Word::axis_errors,
     {"Errors of axis {} at positions", "Abweichungen der Achse {} an Positionen", "{} 轴各位置的误差",
      "{} 軸の各位置における誤差"}},
    {Word::position, {"Position", "Position", "位置", "位置"}},
    {Word::target, {"Target", "Ziel", "目标位置", "目標位置"}},
    {Word::diagonal, {"Diagonal", "Diagonale", "对角线", "対角線"}},
    {Word::mean_positive, {"mean ↑", "Mittel ↑", "平均 ↑", "平均 ↑"}},
    {Word::mean_negative, {"mean ↓", "Mittel ↓", "平均 ↓", "平均 ↓"}},
    {Word::scatter_positive, {"s ↑", "s ↑", "s ↑", "s ↑"}},
    {Word::scatter_negative, {"s ↓", "s ↓", "s ↓", "s ↓"}},
    {Word::reversal, {"reversal B", "Umkehrspanne B", "反向差值 B", "反転値 B"}},
    {Word::mean_both, {"mean of both", "Mittel beider", "双向平均", "両方向平均"}},
    {Word::deviation, {"Deviation", "Abweichung", "偏差", "偏差"}},
    {Word::positive_approach,
     {"mean ↑ (positive approach)", "Mittel ↑ (positive Anfahrt)", "平均 ↑（正向趋近）", "平均 ↑（正の向き）"}},
    {Word::negative_approach,
     {"mean ↓ (negative approach)", "Mittel ↓ (negative Anfahrt)", "平均 ↓（负向趋近）", "平均 ↓（負の向き）"}},
    {Word::mean_with_scatter, {"mean ± 2s", "Mittel ± 2s", "平均 ± 2s", "平均 ± 2s"}},
    {Word::there, {"{} ↑", "{} ↑", "{} ↑", "{} ↑"}},
    {Word::back, {"{} ↓", "{} ↓", "{} ↓", "{} ↓"}},
    {Word::drawing_linear,
     {"Positioning error motions of the linear axes, band U (k = 2)",
      "Positionierabweichungen der Linearachsen, Band U (k = 2)", "线性轴线的定位误差运动，带宽 U（k = 2）",
      "直進軸の位置決め誤差運動、帯は U（k = 2）"}},
    {Word::drawing_rotary,
     {"Angular positioning error motions of the rotary axes, band U (k = 2)",
      "Winkelpositionierabweichungen der Drehachsen, Band U (k = 2)", "回转轴线的角度定位误差运动，带宽 U（k = 2）",
      "回転軸の角度位置決め誤差運動、帯は U（k = 2）"}},
    {Word::must_not_be_used,
     {"This result must not be used as it is.", "Dieses Ergebnis darf so nicht verwendet werden.",
      "该结果不可直接使用。", "この結果はそのまま使用できません。"}},
    {Word::out_of_tolerance,
     {"Beyond the tolerance, or not evaluated: {}.", "Außerhalb der Toleranz oder nicht ausgewertet: {}.",
      "超出公差或未评定：{}。", "許容値を超えた、又は評価されていない特性値：{}。"}},
    {Word::simulated,
     {"Simulated: the readings were computed; no machine was measured.",
      "Simuliert: Die Messwerte sind berechnet; es wurde keine Maschine gemessen.",
      "仿真：读数由计算得到，未对任何机床进行测量。",
      "シミュレーション：測定値は計算によるもので、機械は測定していません。"}},
    {Word::few_runs,
     {"ISO 230-2 asks for at least five runs from each side; the fewest here is {}.",
      "ISO 230-2 verlangt mindestens fünf Anfahrten von jeder Seite; hier sind es an einer Stelle {}.",
      "ISO 230-2 要求每个方向至少五次趋近；此处最少为 {} 次。",
      "ISO 230-2 は各方向から 5 回以上の位置決めを求めていますが、最少は {} 回です。"}},
    {Word::uneven_runs,
     {"The number of readings from one side differs between positions: {} to {}.",
      "Die Anzahl der Messwerte von einer Seite ist nicht an allen Positionen gleich: {} bis {}.",
      "各位置单方向的读数数量不同：{} 至 {}。", "一方向の測定回数が位置によって異なります：{} ～ {}。"}},
    {Word::few_targets,
     {"ISO 230-2 asks for at least {} target positions on a travel of {}; there are {}.",
      "ISO 230-2 verlangt mindestens {} Zielpositionen auf einem Weg von {}; es sind {}.",
      "ISO 230-2 要求至少 {} 个目标位置（行程 {}）；此处为 {} 个。",
      "ISO 230-2 は {} 点以上の目標位置（移動量 {}）を求めていますが、{} 点です。"}},
    {Word::equal_spacing,
     {"The targets are equally spaced: deviations that repeat with their distance, or a whole fraction of it, do not "
      "show.",
      "Die Ziele haben gleiche Abstände: Abweichungen, die sich mit diesem Abstand oder einem ganzen Teil davon "
      "wiederholen, sind nicht erkennbar.",
      "目标位置等间距：以该间距或其整数分之一为周期的偏差无法显现。",
      "目標位置が等間隔です：その間隔又は整数分の一の周期をもつ偏差は現れません。"}},
    {Word::no_readings, {"there are no readings", "keine Messwerte", "没有读数", "測定値がありません"}},
    {Word::needs_two_runs,
     {"a position was read once only", "eine Position wurde nur einmal gemessen", "某位置仅测量一次",
      "1 回しか測定していない位置があります"}},
    {Word::needs_both_directions,
     {"a position was approached from one side only", "eine Position wurde nur von einer Seite angefahren",
      "某位置仅从一个方向趋近", "一方向からしか位置決めしていない位置があります"}},
    {Word::needs_this_direction,
     {"a position was not approached from this side", "eine Position wurde von dieser Seite nicht angefahren",
      "某位置未从该方向趋近", "この方向から位置決めしていない位置があります"}},
    {Word::needs_two_positions,
     {"a span needs two positions", "eine Spannweite braucht zwei Positionen", "范围需要两个位置",
      "範囲には 2 点以上の位置が必要です"}},
    {Word::notes, {"Conditions and notes", "Bedingungen und Hinweise", "条件与说明", "条件及び注記"}},
    {Word::notes_in_english,
     {"Of the evaluation", "Der Auswertung (englisch)", "评定说明（英文）", "評価に関する注記（英文）"}},
    {Word::signatures, {"Signatures", "Unterschriften", "签字", "署名"}},
    {Word::tested_by, {"Tested by", "Geprüft durch", "检测", "試験実施者"}},
    {Word::accepted_by, {"Accepted by", "Abgenommen durch", "验收", "受領者"}},
    {Word::place_and_date, {"Place, date", "Ort, Datum", "地点、日期", "場所・日付"}},
    {Word::name, {"Name", "Name", "姓名", "氏名"}},
    {Word::signature, {"Signature", "Unterschrift", "签名", "署名"}},
    {Word::produced_by, {"Produced by {}", "Erstellt mit {}", "由 {} 生成", "{} により作成"}},
    {Word::files, {"Files", "Dateien", "文件", "ファイル"}},
    {Word::positioning_motion,
     {"linear positioning error motion", "Positionierabweichung", "定位误差运动", "位置決め誤差運動"}},
    {Word::straightness_motion,
     {"straightness error motion in {}", "Geradheitsabweichung in {}", "{} 方向直线度误差运动",
      "{} 方向の真直度誤差運動"}},
    {Word::angular_motion,
     {"angular error motion about {}", "Winkelabweichung um {}", "绕 {} 轴的角度误差运动",
      "{} 軸まわりの角度誤差運動"}},
    {Word::radial_motion,
     {"radial error motion in {}", "Radialabweichung in {}", "{} 方向径向误差运动", "{} 方向の半径方向誤差運動"}},
    {Word::axial_motion, {"axial error motion", "Axialabweichung", "轴向误差运动", "軸方向誤差運動"}},
    {Word::tilt_motion,
     {"tilt error motion about {}", "Kippabweichung um {}", "绕 {} 轴的倾斜误差运动", "{} 軸まわりの傾斜誤差運動"}},
    {Word::rotary_positioning_motion,
     {"angular positioning error motion", "Winkelpositionierabweichung", "角度定位误差运动", "角度位置決め誤差運動"}},
    {Word::other_motion, {"error motion {}", "Bewegungsabweichung {}", "误差运动 {}", "誤差運動 {}"}},
    {Word::orientation,
     {"orientation of axis {} about {}", "Richtung der Achse {}, Drehung um {}", "{} 轴线绕 {} 的方向误差",
      "{} 軸の {} まわりの姿勢誤差"}},
    {Word::offset,
     {"position of axis {} in {}", "Lage der Achse {} in {}", "{} 轴线沿 {} 的位置误差", "{} 軸の {} 方向の位置誤差"}},
    {Word::reversal_value,
     {"reversal value of axis {}", "Umkehrspanne der Achse {}", "{} 轴反向差值", "{} 軸の反転値"}},
    {Word::volumetric_mean,
     {"volumetric error, mean", "volumetrische Abweichung, Mittel", "体积误差，平均", "空間誤差、平均"}},
    {Word::volumetric_largest,
     {"volumetric error, largest", "volumetrische Abweichung, größte", "体积误差，最大", "空間誤差、最大"}},
};
static_assert(std::size(kWords) == static_cast<std::size_t>(Word::count_));

struct FigureInLanguages {
  std::string_view symbol;
  std::array<const char*, kReportLanguageCount> names;
};

constexpr FigureInLanguages kFigures[] = {
    {"A",
     {"bidirectional accuracy of positioning", "beidseitige Positioniergenauigkeit", "双向定位精度",
      "両方向位置決めの正確さ"}},
    {"A+",
     {"unidirectional accuracy ↑", "einseitige Positioniergenauigkeit ↑", "单向定位精度 ↑",
      "一方向位置決めの正確さ ↑"}},
    {"A-",
     {"unidirectional accuracy ↓", "einseitige Positioniergenauigkeit ↓", "单向定位精度 ↓",
      "一方向位置決めの正確さ ↓"}},
    {"E",
     {"bidirectional systematic deviation", "beidseitige systematische Positionierabweichung", "双向定位系统偏差",
      "両方向位置決めの系統偏差"}},
    {"E+",
     {"unidirectional systematic deviation ↑", "einseitige systematische Positionierabweichung ↑", "单向定位系统偏差 ↑",
      "一方向位置決めの系統偏差 ↑"}},
    {"E-",
     {"unidirectional systematic deviation ↓", "einseitige systematische Positionierabweichung ↓", "单向定位系统偏差 ↓",
      "一方向位置決めの系統偏差 ↓"}},
    {"M",
     {"range of the mean bidirectional deviation", "Spannweite der mittleren beidseitigen Positionierabweichung",
      "平均双向定位偏差的范围", "平均両方向位置決め偏差の範囲"}},
    {"R",
     {"bidirectional repeatability of positioning", "beidseitige Wiederholpräzision", "双向重复定位精度",
      "両方向位置決めの繰返し性"}},
    {"R+",
     {"unidirectional repeatability ↑", "einseitige Wiederholpräzision ↑", "单向重复定位精度 ↑",
      "一方向位置決めの繰返し性 ↑"}},
    {"R-",
     {"unidirectional repeatability ↓", "einseitige Wiederholpräzision ↓", "单向重复定位精度 ↓",
      "一方向位置決めの繰返し性 ↓"}},
    {"B", {"reversal value", "Umkehrspanne", "反向差值", "反転値"}},
    {"B_mean", {"mean reversal value", "mittlere Umkehrspanne", "平均反向差值", "平均反転値"}},
    {"E_d",
     {"largest bidirectional systematic deviation of a diagonal", "größte systematische Abweichung einer Diagonale",
      "对角线的最大双向系统偏差", "対角線の両方向系統偏差の最大値"}},
    {"B_d",
     {"largest reversal of a diagonal", "größte Umkehrspanne einer Diagonale", "对角线的最大反向差值",
      "対角線の反転値の最大値"}},
    {"R_d",
     {"largest bidirectional repeatability of a diagonal", "größte Wiederholpräzision einer Diagonale",
      "对角线的最大双向重复定位精度", "対角線の両方向繰返し性の最大値"}},
    {"A_d",
     {"largest bidirectional accuracy of a diagonal", "größte Positioniergenauigkeit einer Diagonale",
      "对角线的最大双向定位精度", "対角線の両方向正確さの最大値"}},
};

}  // namespace

std::string_view customer_word(CustomerWord word, ReportLanguage language) {
  const WordInLanguages& entry = kWords[static_cast<std::size_t>(word)];
  assert(entry.word == word);
  return entry.texts[static_cast<std::size_t>(language)];
}

std::string customer_text(CustomerWord word, ReportLanguage language, const std::vector<std::string>& places) {
  constexpr std::string_view kPlace = "{}";
  const std::string_view text = customer_word(word, language);
  std::string filled;
  std::size_t at = 0;
  for (const std::string& place : places) {
    const std::size_t found = text.find(kPlace, at);
    assert(found != std::string_view::npos);
    filled += std::string(text.substr(at, found - at)) + place;
    at = found + kPlace.size();
  }
  return filled + std::string(text.substr(at));
}

std::string customer_text(CustomerWord word, ReportLanguage language, const std::string& place) {
  return customer_text(word, language, std::vector<std::string>{place});
}

std::string_view positioning_figure_name(std::string_view symbol, ReportLanguage language) {
  for (const FigureInLanguages& figure : kFigures) {
    if (figure.symbol == symbol) return figure.names[static_cast<std::size_t>(language)];
  }
  return {};
}

}  // namespace abbe
